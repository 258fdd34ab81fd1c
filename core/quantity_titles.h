#pragma once

#include <string>
#include <vector>

namespace grainfield {

/// What a measurement is called for people. Files hold its name only, which scripts rely on.
struct QuantityTitle {
    std::string name;   ///< of the Measurement: "d_liquid"
    std::string title;  ///< "Diffusion coefficient, liquid"
};

/// Measurements of one kind, told apart by a number: "box_16" is "Number variance of a box of 16
/// a".
struct QuantityFamily {
    std::string prefix;         ///< of their names: "box_"
    std::string before, after;  ///< the number in their titles
};

/// What an observable and its measurements are called. Written beside the observable, read by the
/// report.
struct ObservableTitles {
    std::string name;   ///< of the ObservableResult: "msd"
    std::string title;  ///< "Displacement"
    std::vector<QuantityTitle> quantities{};
    std::vector<QuantityFamily> families{};
};

/// "Diffusion coefficient, liquid"; the name with spaces where nobody gives a title.
std::string quantity_title(const std::vector<ObservableTitles>& titles,
                           const std::string& observable, const std::string& measurement);

/// "Displacement"; the name with spaces where nobody gives a title.
std::string observable_title(const std::vector<ObservableTitles>& titles,
                             const std::string& observable);

}  // namespace grainfield
