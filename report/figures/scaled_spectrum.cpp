#include "report/figures/scaled_spectrum.h"

#include <optional>
#include <utility>

#include "report/figures/figure_source.h"

namespace grainfield::report {

namespace {

// S1, or nothing and why.
std::optional<double> slope_of(const Results& run, std::string& reason) {
    const ObservableResult* fit = run.find("fit");
    if (fit == nullptr) {
        reason = "no fit of S(k) among its observables";
        return std::nullopt;
    }
    const Measurement* s1 = fit->find_measurement("s1");
    // The analysis gives no S0/S1 where it does not know that S grows with k.
    const Measurement* ratio = fit->find_measurement("s0_over_s1");
    if (fit->reason.empty() && ratio != nullptr && !ratio->value) {
        reason = ratio->reason;
        return std::nullopt;
    }
    if (!fit->reason.empty() || s1 == nullptr || !s1->value) {
        reason = !fit->reason.empty() ? fit->reason : "its fit has no S1";
        return std::nullopt;
    }
    if (*s1->value > 0) return *s1->value;
    reason = "S does not grow with k in the range of its fit";
    return std::nullopt;
}

// Between walls: plane waves, which leak there, instead of the modes that fit between them.
bool fits_plane_waves(const Results& run) {
    const OptionValue* modes = run.find("fit")->find_option("modes");
    return modes != nullptr && to_text(*modes) == "plane-waves";
}

void divide(Series& series, double by) {
    for (double& y : series.y) y /= by;
    for (double& error : series.error) error /= by;
}

void add(Figure& figure, const Results& run, std::size_t r, std::size_t kind,
         const CurveColumns& source, double s1) {
    const Curve* curve = find_curve(run, source);
    if (curve == nullptr) return;
    auto series = take(*curve, source, [](std::size_t) { return true; });
    if (!series) return;
    series->run = r;
    series->kind = kind;
    divide(*series, s1);
    figure.series.push_back(std::move(*series));
}

}  // namespace

Figure scaled_spectrum(const std::vector<Results>& runs, const std::vector<std::string>& labels) {
    const CurveColumns plane{"sk", "sk", "k", "s", "s_err"};
    const CurveColumns walls{"sk", "sk_neumann", "k", "s", "s_err"};
    Figure figure =
        empty_figure(labels, "sk_scaled", "Structure factor over S₁",
                     {"k", "Wavevector k", "1/a", Scale::log, true, column_units(runs, plane)},
                     {"s_over_s1", "S(k)/S₁", "", Scale::log, true});
    figure.kinds = {{"S(k)/S₁", Mark::line, true}, {"fit, S₀/S₁ + (ka)^α", Mark::curve, true}};
    figure.may_be_linear = true;
    figure.note = "At small k the curves tend to S₀/S₁. The error of S₁ is not in the error bars.";
    for (std::size_t r = 0; r < runs.size(); ++r) {
        std::string reason;
        const std::optional<double> s1 = slope_of(runs[r], reason);
        if (!s1) {
            figure.absent.push_back({r, reason});
            continue;
        }
        const bool cosines = find_curve(runs[r], walls) != nullptr && !fits_plane_waves(runs[r]);
        const CurveColumns& fitted = cosines ? walls : plane;
        add(figure, runs[r], r, 0, fitted, *s1);
        add(figure, runs[r], r, 1, {"fit", "fit", "k", "s", "s_err"}, *s1);
    }
    return figure;
}

}  // namespace grainfield::report
