#include "analysis/observables.h"

#include <algorithm>
#include <sstream>

#include "analysis/density/field_statistics.h"
#include "analysis/density/synthetic_observable.h"
#include "analysis/density/variance_observable.h"
#include "analysis/motion/msd_observable.h"
#include "analysis/order/phase_observable.h"
#include "analysis/order/q4_observable.h"
#include "analysis/spectra/fit_observable.h"
#include "analysis/spectra/s4_observable.h"
#include "analysis/spectra/sk_observable.h"
#include "analysis/statistics/run_series.h"
#include "core/errors.h"

namespace grainfield::analysis {

const std::vector<Observable>& observables() {
    static const std::vector<Observable> all{
        observable_of<Q4Observable>(),  observable_of<PhaseObservable>(),
        observable_of<MsdObservable>(), observable_of<SkObservable>(),
        observable_of<S4Observable>(),  observable_of<VarianceObservable>(),
        observable_of<FitObservable>(), observable_of<SyntheticObservable>(),
    };
    return all;
}

std::vector<Observable> chosen(const std::string& list, const std::vector<Observable>& known) {
    std::vector<std::string> names{"all"};
    for (const Observable& observable : known) names.push_back(observable.name);
    std::string expected = "some of all";
    for (const Observable& observable : known) expected += ", " + observable.name;
    std::vector<std::string> wanted;
    std::istringstream entries(list);
    for (std::string entry; std::getline(entries, entry, ',');) {
        entry.erase(0, entry.find_first_not_of(" \t"));
        entry.erase(entry.find_last_not_of(" \t") + 1);
        if (entry.empty()) continue;
        if (std::ranges::find(names, entry) == names.end()) {
            const std::string nearest = nearest_name(entry, names);
            throw OptionError(ErrorText{"unknown observable", "'" + entry + "'", expected,
                                        nearest.empty() ? "" : "did you mean " + nearest + "?"});
        }
        wanted.push_back(entry);
    }
    if (wanted.empty()) {
        throw OptionError(
            ErrorText{"no observables are asked for", "'" + list + "'", expected, ""});
    }
    const auto is_wanted = [&](const std::string& name) {
        return std::ranges::find(wanted, name) != wanted.end();
    };
    if (is_wanted("all")) return known;
    std::vector<Observable> taken;
    std::ranges::copy_if(known, std::back_inserter(taken),
                         [&](const Observable& o) { return is_wanted(o.name); });
    return taken;
}

std::vector<FigureHint> figure_hints(const std::vector<Observable>& known) {
    std::vector<FigureHint> hints;
    const auto add = [&](std::vector<FigureHint> more) {
        std::ranges::move(more, std::back_inserter(hints));
    };
    for (const Observable& observable : known) add(observable.figures());
    add(field_figures());
    add(run_series_figures());
    std::ranges::stable_sort(hints, {}, &FigureHint::place);
    return hints;
}

}  // namespace grainfield::analysis
