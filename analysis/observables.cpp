#include "analysis/observables.h"

#include <algorithm>
#include <iterator>

#include "analysis/density/field_statistics.h"
#include "analysis/density/synthetic_observable.h"
#include "analysis/density/variance_observable.h"
#include "analysis/motion/height_observable.h"
#include "analysis/motion/msd_observable.h"
#include "analysis/order/phase_observable.h"
#include "analysis/order/q4_observable.h"
#include "analysis/pairs/pairs_observable.h"
#include "analysis/spectra/fit_observable.h"
#include "analysis/spectra/s4_observable.h"
#include "analysis/spectra/sk_observable.h"
#include "analysis/statistics/critical_result.h"
#include "analysis/statistics/run_series.h"
#include "core/errors.h"

namespace grainfield::analysis {

const std::vector<Observable>& observables() {
    static const std::vector<Observable> all{
        observable_of<Q4Observable>(),    observable_of<PhaseObservable>(),
        observable_of<MsdObservable>(),   observable_of<SkObservable>(),
        observable_of<S4Observable>(),    observable_of<VarianceObservable>(),
        observable_of<FitObservable>(),   observable_of<SyntheticObservable>(),
        observable_of<PairsObservable>(), observable_of<HeightObservable>(),
    };
    return all;
}

std::vector<std::string> names_for(const std::vector<Observable>& known) {
    std::vector<std::string> names{all_observables};
    for (const Observable& observable : known) names.push_back(observable.name);
    return names;
}

std::vector<Observable> chosen(const std::vector<std::string>& wanted,
                               const std::vector<Observable>& known) {
    const std::vector<std::string> names = names_for(known);
    std::string expected = "some of all";
    for (const Observable& observable : known) expected += ", " + observable.name;
    for (const std::string& name : wanted) {
        if (std::ranges::find(names, name) != names.end()) continue;
        const std::string nearest = nearest_name(name, names);
        throw OptionError(ErrorText{"unknown observable", "'" + name + "'", expected,
                                    nearest.empty() ? "" : "did you mean " + nearest + "?"});
    }
    if (wanted.empty()) {
        throw OptionError(ErrorText{"no observables are asked for", "none", expected, ""});
    }
    const auto is_wanted = [&](const std::string& name) {
        return std::ranges::find(wanted, name) != wanted.end();
    };
    if (is_wanted(all_observables)) return known;
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

std::vector<ObservableTitles> titles(const std::vector<Observable>& known) {
    std::vector<ObservableTitles> titles;
    for (const Observable& observable : known) titles.push_back(observable.titles());
    std::ranges::move(field_titles(), std::back_inserter(titles));
    titles.push_back(run_series_titles());
    titles.push_back(critical_titles());
    return titles;
}

}  // namespace grainfield::analysis
