#pragma once

#include <string>

namespace grainfield::analysis {

/// Which observables are wanted.
struct ObservableSet {
    bool q4 = false;
    bool phase = false;
    bool msd = false;
    bool sk = false;
    bool s4 = false;
    bool variance = false;
    bool fit = false;
    bool synthetic = false;

    /// From "all" or a comma list such as "q4,sk". Throws OptionError naming the unknown entry, or
    /// if the list is empty.
    static ObservableSet parse(const std::string& list);
};

}  // namespace grainfield::analysis
