#include "pipelines/validate/validation_outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace grainfield::pipelines {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kLowK = 0.3;       // [1/a]
constexpr double kBoundSpeaks = 3;  // error over bound, at most

const std::vector<double>* column(const Results& run, const char* observable, const char* curve,
                                  const char* name) {
    const ObservableResult* result = run.find(observable);
    const Curve* found = result == nullptr ? nullptr : result->find_curve(curve);
    const Column* values = found == nullptr ? nullptr : found->find(name);
    return values == nullptr ? nullptr : &values->values;
}

const ObservableResult* observable_of(const ValidationOutcome& outcome, std::size_t run,
                                      const std::string& name) {
    if (name != "free fit") return outcome.runs[run].find(name);
    return run < outcome.free_fits.size() ? &outcome.free_fits[run] : nullptr;
}

/// A measurement of one run, or the reason why there is none.
struct Found {
    double value = kNone;
    double error = kNone;
    Unit unit;
    std::string reason;
};

Found found_in(const ObservableResult* observable, const ComparedMeasurement& wanted) {
    Found found;
    if (observable == nullptr) {
        found.reason = fmt::format("the analysis has no observable '{}'", wanted.observable);
        return found;
    }
    const Measurement* m = observable->find_measurement(wanted.measurement);
    if (m == nullptr && wanted.of_one_frame != nullptr) {
        m = observable->find_measurement(wanted.of_one_frame);
    }
    if (m == nullptr) {
        found.reason = !observable->reason.empty()
                           ? observable->reason
                           : fmt::format("'{}' has no measurement '{}'", wanted.observable,
                                         wanted.measurement);
        return found;
    }
    found.value = m->value.value_or(kNone);
    found.error = m->error.value_or(kNone);
    found.unit = m->unit;
    if (!m->value || !m->error) found.reason = m->reason;
    return found;
}

void add_measurements(ValidationOutcome& outcome) {
    for (const ComparedMeasurement& wanted : compared_measurements()) {
        const Found truth = found_in(observable_of(outcome, 0, wanted.observable), wanted);
        const Found tracked = found_in(observable_of(outcome, 1, wanted.observable), wanted);
        std::string reason = tracked.reason;
        if (reason.empty() && !truth.reason.empty()) reason = "true: " + truth.reason;
        outcome.effects.push_back({wanted.name, wanted.title,
                                   tracked.unit.is_dimensionless() ? truth.unit : tracked.unit,
                                   truth.value, tracked.value, tracked.error, std::move(reason)});
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

std::string bound_caveat(const ValidationOutcome& outcome) {
    const tracking::ClassScore& all = outcome.scores.detection().find("all");
    const double ratio = all.bound_ratio();
    if (!(ratio > kBoundSpeaks)) return {};
    const std::string bound = fmt::format(
        "the Cramér–Rao bound of {:.3g} px is no measure here: it knows the noise of "
        "the camera alone, and the error is {:.0f} times as large",
        all.bound(), ratio);
    if (outcome.truth_is_whole) {
        return bound +
               fmt::format(", as truths rounded to whole pixels make {} px", kRoundingError);
    }
    return bound +
           "; the rest is what the image model lacks (overlap, reflections, other optics), or an "
           "error of the truth";
}

const std::vector<ComparedMeasurement>& compared_measurements() {
    static const std::vector<ComparedMeasurement> compared{
        {"q4", "q4_mean", "q4_mean", "Mean |Q₄|"},
        {"q4", "lattice_spacing", "lattice_spacing", "Lattice spacing of the solid"},
        {"q4", "nearest_distance", "nearest_distance", "Mean distance of the nearest neighbour"},
        {"phase", "solid_fraction", "solid_fraction", "Solid fraction"},
        {"phase", "liquid_fraction", "liquid_fraction", "Liquid fraction"},
        {"variance", "number_density", "number_density", "Number density"},
        {"msd", "d_all", "d_all", "Diffusion coefficient"},
        {"sk", "s_lowest_k", "s_lowest_k", "S at the lowest k"},
        {"variance", "relative_variance_10a", "relative_variance_10a", "σ²/⟨N⟩ at ℓ = 10 a",
         "relative_variance_10a_pooled"},
        {"fit", "s0_over_s1", "s0_over_s1", "S₀/S₁"},
        {"fit", "s0", "s0", "S₀"},
        {"fit", "s1", "s1", "S₁"},
        {"free fit", "alpha", "alpha", "Exponent α, fitted"},
        {"free fit", "s0_over_s1", "s0_over_s1_free_alpha", "S₀/S₁ with α fitted"}};
    return compared;
}

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
            {"s_low_k", "Mean S(k) for ka < 0.3", "-", low_truth, low_tracked, kNone, {}});
    }
    const double deviation = deviation_of_sk(outcome.runs[0], outcome.runs[1]);
    if (std::isfinite(deviation)) {
        outcome.effects.push_back(
            {"sk_deviation", "RMS relative deviation of S(k)", "-", 0, deviation, kNone, {}});
    }
    outcome.msd_offset = first_msd(outcome.runs[1]) - first_msd(outcome.runs[0]);
}

}  // namespace grainfield::pipelines
