#include "analysis/order/phase_observable.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "analysis/order/shared_bond_order.h"
#include "analysis/order/shared_phases.h"

namespace grainfield::analysis {

std::vector<Observable> PhaseObservable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedSquareOrder>(), observable_of<SharedPhases>()};
}

std::optional<OptionTable> PhaseObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<PhaseOptions>());
}

void PhaseObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    const PhaseWindow window = PhaseWindow::of(setup.options.of<PhaseOptions>(), setup.info);
    std::string why = setup.frames == 1    ? "one frame"
                      : !setup.is_linked() ? "not linked"
                                           : window.reason;
    // By the time stamps: the frame rate is that of the camera, also where some frames are taken.
    if (why.empty() && *window.length > 0 && *window.length < (1 - 1e-9) * setup.interval) {
        why = fmt::format("the averaging time {:.4g} is shorter than the frame interval {:.4g}",
                          *window.length, setup.interval);
    }
    plan.run("phase", why.empty() ? fmt::format("average over {:.4g}", *window.length)
                                  : "every frame alone: " + why);
}

std::vector<FigureHint> PhaseObservable::figures() {
    const auto share = [](const char* label, const char* column) {
        return SeriesHint{.label = label, .from = {"phase", "phase", "t", column, ""}};
    };
    return {
        {.name = "phase",
         .title = "Phases",
         .note = "",
         .x = {"t", "Time t", "time unit", Scale::linear, false},
         .y = {"fraction", "Fraction of particles", "", Scale::linear, true},
         .series = {share("solid", "solid_fraction"), share("liquid", "liquid_fraction")},
         .place = 50,
         .presence = Presence::always,
         .least_points = 2,
         .without_time = Axis{"frame", "Frame", "", Scale::linear, false}},
        {.name = "q4_fluctuation",
         .title = "Fluctuation of the order of a particle",
         .note = "Mean and standard deviation of |Q| in the averaging time.",
         .x = {"m", "Mean |Q₄|", "", Scale::linear, true},
         .y = {"sigma", "Standard deviation of |Q₄|", "", Scale::linear, true},
         .series = {{.label = "σ(m)", .from = {"phase", "q4_fluctuation", "m", "sigma", "err"}}},
         .place = 76},
        {.name = "q4_examples",
         .title = "Order of a typical particle of each phase",
         .note = "Through one averaging time.",
         .x = {"t", "Time", "time unit", Scale::linear, true},
         .y = {"q4", "|Q₄|", "", Scale::linear, true},
         .series = {{.label = "", .from = {"phase", "q4_examples", "t", "q4", ""}, .by = "phase"}},
         .place = 77},
        {.name = "clusters",
         .title = "Sizes of the solid clusters",
         .note = "",
         .x = {"size", "Particles in the cluster", "", Scale::log, false},
         .y = {"clusters", "Clusters a window", "", Scale::log, false},
         .series = {{.label = "clusters",
                     .from = {"phase", "clusters", "size", "clusters", "err"}}},
         .place = 78},
    };
}

ObservableTitles PhaseObservable::titles() {
    return {
        name,
        "Phases",
        {
            {"solid_fraction", "Solid fraction"},
            {"liquid_fraction", "Liquid fraction"},
            {"averaging_time", "Averaging time of the phase"},
            {"q4_fluctuation", "Standard deviation of |Q₄| of a particle in the averaging time"},
            {"largest_cluster", "Particles in the largest solid cluster"},
            {"cluster_size", "Solid particles in the cluster of one of them, mean"},
            {"cluster_lifetime", "Lifetime of solid clusters"},
        }};
}

PhaseObservable::PhaseObservable(const RunSetup& setup)
    : options_(setup.options.of<PhaseOptions>()),
      clusters_(PhaseHistory(options_, setup.info, setup.frames).follows()),
      stride_(std::max<std::int64_t>(1, (setup.frames + 63) / 64)) {
    if (PhaseHistory(options_, setup.info, setup.frames).follows()) examples_.emplace(options_);
}

void PhaseObservable::add(Sample& /*sample*/, const Moment& moment) {
    const auto& field = moment.sample_of<SharedSquareOrder>();
    const PhaseHistory& history = moment.of<SharedPhases>().history();
    const bool has_closed = history.windows() > windows_;
    windows_ = history.windows();
    if (examples_ && examples_->wants_more()) {
        if (has_closed) examples_->close_window();
        examples_->add(moment.sample_of<SharedPhases>());
    }
    if (!history.follows()) return add_alone(moment, field);
    if (has_closed) add_clusters(history);
    last_ = {moment.pattern().id, field, moment.pattern().time};
}

// Every frame is its own window; the clusters of 64 of them tell their sizes.
void PhaseObservable::add_alone(const Moment& moment,
                                const std::shared_ptr<const BondOrderField>& field) {
    if (frames_++ % stride_ != 0) return;
    std::vector<bool> solid;
    for (const auto& q : field->q) solid.push_back(std::abs(q) >= options_.solid_above);
    clusters_.add({moment.pattern().id, std::move(solid), field.get(), moment.pattern().time});
}

// The clusters of the window that was closed last, in its last frame.
void PhaseObservable::add_clusters(const PhaseHistory& history) {
    const std::int64_t window = history.window_of(last_.time);
    std::vector<bool> solid;
    for (const std::int64_t id : last_.id) {
        std::int64_t first = 0;
        const auto classes = history.classes(id, first);
        const std::int64_t at = window - first;
        solid.push_back(at >= 0 && at < static_cast<std::int64_t>(classes.size()) &&
                        classes[static_cast<std::size_t>(at)] == Phase::solid);
    }
    clusters_.add({std::move(last_.id), std::move(solid), last_.field.get(), last_.time,
                   history.frames_in(window)});
    last_ = {};
}

void PhaseObservable::merge(const PhaseObservable& later) {
    clusters_.merge(later.clusters_);
    if (examples_ && later.examples_) examples_->merge(*later.examples_);
}

void PhaseObservable::finish(const Inputs& inputs) {
    const PhaseHistory& history = inputs.of<SharedPhases>().history();
    if (history.follows() && !last_.id.empty()) add_clusters(history);
    if (examples_) examples_->close_window();
}

ObservableResult PhaseObservable::result(const Inputs& inputs) const {
    const PhaseHistory& history = inputs.of<SharedPhases>().history();
    ObservableResult result = history.result();
    clusters_.add_to(result, history.rule());
    if (examples_) examples_->add_to(result);
    return result;
}

}  // namespace grainfield::analysis
