#include "analysis/order/q4_observable.h"

#include <fmt/format.h>

#include "analysis/order/phase.h"
#include "analysis/order/shared_bond_order.h"

namespace grainfield::analysis {

std::vector<Observable> Q4Observable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedBondOrder>()};
}

std::optional<OptionTable> Q4Observable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<BondOrderOptions>());
}

void Q4Observable::plan(const PlanSetup& setup, RunPlan& plan) {
    const auto& options = setup.options.of<BondOrderOptions>();
    plan.run("q4", fmt::format("|Q{}| of every particle, neighbours by {}", options.symmetry,
                               needs_triangulation(options.rule) ? "triangulation" : "distance"));
}

std::vector<FigureHint> Q4Observable::figures() {
    const Axis correlation{"c", "⟨Re Q*(0) Q(r)⟩/⟨|Q|²⟩", "", Scale::linear, true};
    const Axis in_time{"c", "⟨Re Q*(t) Q(t + τ)⟩/⟨|Q|²⟩", "", Scale::linear, true};
    return {
        {.name = "q4_histogram",
         .title = "Bond-orientational order",
         .note = "",
         .x = {"q4", "|Q₄|", "", Scale::linear, true},
         .y = {"density", "Probability density", "", Scale::linear, true},
         .series = {{.label = "density",
                     .mark = Mark::steps,
                     .from = {"q4", "q4_histogram", "q4", "density", "err"}}},
         .place = 10,
         .presence = Presence::always,
         .x_names_order = true,
         .note_of_square_order = "Liquid lies near 0.3, the square crystal near 0.95.",
         .reading = "How four-fold the neighbours of each sphere stand, 0 to 1. Two peaks mean two "
                    "phases side by side; one peak near 0.3 is a liquid."},
        {.name = "q4_space",
         .title = "Correlation of the order in space",
         .note = "",
         .x = {"r", "Distance r", "a", Scale::linear, true},
         .y = correlation,
         .series = {{.label = "C(r)", .from = {"q4", "q4_space", "r", "c", "err"}}},
         .place = 74},
        {.name = "q4_time",
         .title = "Correlation of the order in time",
         .note = "",
         .x = {"t", "Lag time τ", "time unit", Scale::log, false},
         .y = in_time,
         .series = {{.label = "C(τ)", .from = {"q4", "q4_time", "t", "c", "err"}}},
         .place = 75},
    };
}

ObservableTitles Q4Observable::titles() {
    ObservableTitles titles{name, "Bond-orientational order"};
    const auto add = [&](std::string quantity, std::string title) {
        titles.quantities.push_back({std::move(quantity), std::move(title)});
    };
    for (int k = least_symmetry; k <= most_symmetry; ++k) {
        const std::string order = order_symbol(k);
        add(order_name(k, "mean"), "Mean " + order);
        add(order_name(k, "low_mode"), order + " of the liquid peak");
        add(order_name(k, "high_mode"), order + " of the solid peak");
        add(order_name(k, "minimum"), order + " between the peaks");
    }
    add("nearest_distance", "Mean distance of the nearest neighbour");
    add("lattice_spacing", "Lattice spacing of the solid, projected");
    add("order_length", "Distance at which the order is correlated by 1/e");
    add("order_time", "Time in which the correlation of the order falls to 1/e");
    return titles;
}

Q4Observable::Q4Observable(const RunSetup& setup)
    : bonds_(setup.options.of<BondOrderOptions>(), setup.options.of<PhaseOptions>().solid_above),
      correlation_(setup.box, setup.whole > 0 ? setup.whole : setup.frames, setup.first) {}

Q4Observable::Sample Q4Observable::measure(const Moment& moment) const {
    return correlation_.measure(moment.pattern(), *moment.sample_of<SharedBondOrder>(),
                                moment.ordinal());
}

void Q4Observable::add(Sample& sample, const Moment& moment) {
    const auto& field = moment.sample_of<SharedBondOrder>();
    correlation_.add(sample, moment.pattern(), *field);
    bonds_.add({moment.pattern().frame, moment.pattern().id, field});
}

void Q4Observable::merge(const Q4Observable& later) {
    bonds_.merge(later.bonds_);
    correlation_.merge(later.correlation_);
}

ObservableResult Q4Observable::result(const Inputs& /*inputs*/) const {
    ObservableResult result = bonds_.result();
    correlation_.add_to(result);
    return result;
}

}  // namespace grainfield::analysis
