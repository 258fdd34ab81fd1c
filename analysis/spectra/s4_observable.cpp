#include "analysis/spectra/s4_observable.h"

#include <fmt/format.h>

#include "analysis/order/shared_bond_order.h"

namespace grainfield::analysis {

std::vector<Observable> S4Observable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedBondOrder>()};
}

std::optional<OptionTable> S4Observable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<OrderStructureFactorOptions>());
}

void S4Observable::plan(const PlanSetup& setup, RunPlan& plan) {
    plan.run("s4", fmt::format("structure factor of Q{}, two weighted sums over the particles",
                               setup.options.of<BondOrderOptions>().symmetry));
}

std::vector<FigureHint> S4Observable::figures() {
    return {{.name = "s4",
             .title = "Structure factor of the order",
             .note = "",
             .x = {"k", "Wavevector k", "1/a", Scale::log, true},
             .y = {"s", "S₄(k)", "", Scale::log, true},
             .series = {{.label = "S₄(k)", .from = {"s4", "s4", "k", "s", "s_err"}},
                        {.label = "Ornstein–Zernike, S₄(0)/(1 + (ξ₄k)²)",
                         .mark = Mark::curve,
                         .from = {"s4", "s4_fit", "k", "s", ""}}},
             .place = 60,
             .presence = Presence::with_observable,
             .may_be_linear = true,
             .title_of_curve = true}};
}

ObservableTitles S4Observable::titles() {
    return {name,
            "Structure factor of the order",
            {
                {"s4_zero", "S₄(0)"},
                {"xi4", "Correlation length ξ₄ of the order"},
                {"s4_lowest_k", "S₄ at the lowest k"},
                {"lowest_k", "Lowest k"},
                {"chi2_per_dof", "χ² per degree of freedom"},
                {"s4_growth", "S₄, last third of the run over the first"},
            }};
}

S4Observable::Sample S4Observable::measure(const Moment& moment) const {
    return sums_.measure(moment.pattern(), moment.sample_of<SharedBondOrder>()->q);
}

}  // namespace grainfield::analysis
