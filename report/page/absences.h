#pragma once

#include <string>
#include <vector>

#include "core/quantity_titles.h"
#include "core/results.h"
#include "report/figures/figure.h"

namespace grainfield::report {

/// Something that a run does not have.
struct Absent {
    std::string what;        ///< "Displacement", "errors of S(k)"
    std::string reason;      ///< as the analysis says it
    bool one_frame = false;  ///< more frames would bring it
};

/// What the results lack: observables and numbers without a value, an observable that has none at
/// all as one entry; of one frame also the errors of S. Curves are not named besides.
std::vector<Absent> absences(const Results& run, const std::vector<ObservableTitles>& titles);

/// One line a run, "Not possible with one frame: phases, displacement", which unfolds to the
/// reasons. Empty if nothing is missing. Runs that lack the same share a line.
std::string absences_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                          const std::vector<ObservableTitles>& titles);

}  // namespace grainfield::report
