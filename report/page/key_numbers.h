#pragma once

#include <string>
#include <vector>

#include "core/quantity_titles.h"
#include "core/results.h"

namespace grainfield::report {

/// A number for people: text with its error, how many samples, and the note that goes with it.
struct KeyNumber {
    std::string value;    ///< "0.931 ± 0.002"; empty: not measured, the note says why
    std::string samples;  ///< "10,456"; empty if unknown
    std::string note;     ///< reason why there is no value or no error; may be empty
};

/// One quantity, side by side for all runs.
struct KeyNumberRow {
    std::string observable;          ///< "Structure factor"
    std::string quantity;            ///< "Diffusion coefficient, liquid"
    std::string name;                ///< "d_liquid", as in the results file
    std::string unit;                ///< "a²/s", of the first run that has it
    std::vector<KeyNumber> numbers;  ///< one a run
};

/// All measurements of all runs in the order in which they first appear; frames and particles
/// first. An observable without any measurement has one row with its reason.
std::vector<KeyNumberRow> key_numbers(const std::vector<Results>& runs,
                                      const std::vector<ObservableTitles>& titles);

/// The table as HTML, without rows that no run has a value for (`absences`). One run: samples and
/// note in columns of their own; several: one column a run, notes numbered and listed once below.
std::string key_numbers_html(const std::vector<KeyNumberRow>& rows,
                             const std::vector<std::string>& labels);

}  // namespace grainfield::report
