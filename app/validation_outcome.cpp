#include "app/validation_outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace grainfield::app {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kLowK = 0.3;  // [1/a]

const std::vector<double>* column(const Results& run, const char* observable, const char* curve,
                                  const char* name) {
    const ObservableResult* result = run.find(observable);
    const Curve* found = result == nullptr ? nullptr : result->find_curve(curve);
    const Column* values = found == nullptr ? nullptr : found->find(name);
    return values == nullptr ? nullptr : &values->values;
}

void add_measurements(ValidationOutcome& outcome) {
    static const std::map<std::string, std::string> titles{
        {"q4_mean", "Mean |Q₄|"},
        {"lattice_spacing", "Lattice spacing of the solid"},
        {"nearest_distance", "Mean distance of the nearest neighbour"},
        {"solid_fraction", "Solid fraction"},
        {"liquid_fraction", "Liquid fraction"},
        {"number_density", "Number density"},
        {"d_all", "Diffusion coefficient"},
        {"s_lowest_k", "S at the lowest k"},
        {"relative_variance_10a", "σ²/⟨N⟩ at ℓ = 10 a"}};
    for (const ObservableResult& observable : outcome.runs[0].observables) {
        const ObservableResult* other = outcome.runs[1].find(observable.name);
        if (other == nullptr) continue;
        for (const Measurement& m : observable.measurements) {
            const Measurement* n = other->find_measurement(m.name);
            const auto title = titles.find(m.name);
            if (n == nullptr || !m.value || !n->value || title == titles.end()) continue;
            outcome.effects.push_back(
                {m.name, title->second, m.unit, *m.value, *n->value, n->error.value_or(kNone)});
        }
    }
}

/// Mean of S over the modes below kLowK, weighted by their number.
double low_k_mean(const Results& run) {
    const auto* k = column(run, "sk", "sk", "k");
    const auto* s = column(run, "sk", "sk", "s");
    const auto* n = column(run, "sk", "sk", "n");
    if (k == nullptr || s == nullptr || n == nullptr) return kNone;
    double sum = 0;
    double modes = 0;
    for (std::size_t i = 0; i < k->size(); ++i) {
        if ((*k)[i] >= kLowK || !std::isfinite((*s)[i])) continue;
        sum += (*n)[i] * (*s)[i];
        modes += (*n)[i];
    }
    return modes > 0 ? sum / modes : kNone;
}

double deviation_of_sk(const Results& truth, const Results& tracked) {
    const auto* a = column(truth, "sk", "sk", "s");
    const auto* b = column(tracked, "sk", "sk", "s");
    if (a == nullptr || b == nullptr || a->size() != b->size()) return kNone;
    double squares = 0;
    double count = 0;
    for (std::size_t i = 0; i < a->size(); ++i) {
        const double relative = (*b)[i] / (*a)[i] - 1;
        if (!std::isfinite(relative)) continue;
        squares += relative * relative;
        ++count;
    }
    return count > 0 ? std::sqrt(squares / count) : kNone;
}

/// MSD of all particles at the shortest lag.
double first_msd(const Results& run) {
    const auto* msd = column(run, "msd", "msd", "msd");
    return msd == nullptr || msd->empty() ? kNone : msd->front();
}

}  // namespace

void compare_downstream(ValidationOutcome& outcome) {
    outcome.effects.clear();
    const double sigma = outcome.scores.detection().find("all").rmse_per_axis() /
                         outcome.scores.view().sphere_diameter;
    outcome.predicted_msd_offset = 4 * sigma * sigma;
    outcome.msd_offset = kNone;
    if (outcome.runs.size() < 2) return;
    add_measurements(outcome);
    const double low_truth = low_k_mean(outcome.runs[0]);
    const double low_tracked = low_k_mean(outcome.runs[1]);
    if (std::isfinite(low_truth) && std::isfinite(low_tracked)) {
        outcome.effects.push_back(
            {"s_low_k", "Mean S(k) for ka < 0.3", "-", low_truth, low_tracked, kNone});
    }
    const double deviation = deviation_of_sk(outcome.runs[0], outcome.runs[1]);
    if (std::isfinite(deviation)) {
        outcome.effects.push_back(
            {"sk_deviation", "RMS relative deviation of S(k)", "-", 0, deviation, kNone});
    }
    outcome.msd_offset = first_msd(outcome.runs[1]) - first_msd(outcome.runs[0]);
}

}  // namespace grainfield::app
