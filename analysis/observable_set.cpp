#include "analysis/observable_set.h"

#include <map>
#include <sstream>
#include <vector>

#include "core/errors.h"
#include "core/option_table.h"

namespace grainfield::analysis {

ObservableSet ObservableSet::parse(const std::string& list) {
    ObservableSet set;
    const std::map<std::string, bool ObservableSet::*> members{
        {"q4", &ObservableSet::q4},   {"phase", &ObservableSet::phase},
        {"msd", &ObservableSet::msd}, {"sk", &ObservableSet::sk},
        {"s4", &ObservableSet::s4},   {"variance", &ObservableSet::variance},
        {"fit", &ObservableSet::fit}, {"synthetic", &ObservableSet::synthetic}};
    std::istringstream entries(list);
    std::string entry;
    bool any = false;
    while (std::getline(entries, entry, ',')) {
        entry.erase(0, entry.find_first_not_of(" \t"));
        entry.erase(entry.find_last_not_of(" \t") + 1);
        if (entry.empty()) continue;
        any = true;
        if (entry == "all") {
            for (const auto& [name, member] : members) set.*member = true;
            continue;
        }
        const auto found = members.find(entry);
        if (found == members.end()) {
            std::vector<std::string> names{"all"};
            for (const auto& [name, member] : members) names.push_back(name);
            const std::string nearest = nearest_name(entry, names);
            throw OptionError(
                ErrorText{"unknown observable", "'" + entry + "'",
                          "some of all, q4, phase, msd, sk, s4, variance, fit, synthetic",
                          nearest.empty() ? "" : "did you mean " + nearest + "?"});
        }
        set.*(found->second) = true;
    }
    if (!any) {
        throw OptionError(ErrorText{"no observables are asked for", "'" + list + "'",
                                    "some of all, q4, phase, msd, sk, s4, variance, fit, synthetic",
                                    ""});
    }
    return set;
}

}  // namespace grainfield::analysis
