#include "analysis/curve_fit.h"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/bond_statistics.h"
#include "analysis/fit.h"

namespace grainfield::analysis {

namespace {

// Shells whose four numbers are known; empty if the curves are not there.
Spectrum spectrum_of(const ObservableResult& sk) {
    Spectrum spectrum;
    const Curve* curve = sk.find_curve("sk");
    const Curve* samples = sk.find_curve("sk_samples");
    if (curve == nullptr || samples == nullptr) return spectrum;
    const Column* k = curve->find("k");
    const Column* s = curve->find("s");
    const Column* error = curve->find("s_err");
    const Column* dof = samples->find("dof");
    const bool whole = k != nullptr && s != nullptr && error != nullptr && dof != nullptr &&
                       dof->values.size() == k->values.size();
    if (!whole) return spectrum;
    for (std::size_t i = 0; i < k->values.size(); ++i) {
        const bool known = std::isfinite(s->values[i]) && std::isfinite(dof->values[i]) &&
                           s->values[i] > 0 && dof->values[i] > 0;
        if (!known) continue;
        spectrum.k.push_back(k->values[i]);
        spectrum.s.push_back(s->values[i]);
        spectrum.error.push_back(error->values[i]);
        spectrum.dof.push_back(dof->values[i]);
    }
    return spectrum;
}

Curve drawn(const SpectrumFit& fit, double first, const std::string& unit) {
    Curve curve{"fit",
                fmt::format("S0 + S1 k^{:.3g}", fit.alpha),
                {{"k", unit, "Wavevector k", {}},
                 {"s", "-", "S(k), fitted", {}},
                 {"s_err", "-", "Standard error", {}}},
                {}};
    for (int i = 0; i <= 60; ++i) {
        const double k = first * std::pow(fit.k_max / first, i / 60.0);
        curve.columns[0].values.push_back(k);
        curve.columns[1].values.push_back(fit.value(k));
        curve.columns[2].values.push_back(fit.value_error(k));
    }
    return curve;
}

}  // namespace

ObservableResult curve_fit(const ObservableResult& sk, const FitOptions& options) {
    ObservableResult result;
    result.name = "fit";
    FitOptions copy = options;
    result.options = recorded(describe(copy));
    const Spectrum spectrum = spectrum_of(sk);
    if (spectrum.k.empty()) {
        result.reason = !sk.reason.empty() ? sk.reason : "S(k) has no count of samples to weigh it";
        return result;
    }
    std::optional<double> end = options.k_max;
    if (!end) {
        const PrePeak peak = find_pre_peak(spectrum);
        if (peak.k) end = options.range * *peak.k;
        if (!peak.k) {
            result.reason = peak.reason + ", which sets the range of the fit; give fit.k-max";
            return result;
        }
    }
    std::optional<double> alpha;
    if (options.exponent == Exponent::fixed) alpha = options.alpha;
    const SpectrumFit fit = fit_spectrum(spectrum, *end, alpha, options.method);
    if (!fit.ok()) {
        result.reason = fit.reason;
        return result;
    }
    double samples = 0;
    for (std::size_t i = 0; i < spectrum.k.size() && spectrum.k[i] <= *end; ++i) {
        samples += spectrum.dof[i];
    }
    const std::string why = "error from the likelihood";
    auto& m = result.measurements;
    m.push_back({"s0_over_s1", "-", fit.ratio(), fit.ratio_error(), samples, why});
    m.push_back({"s0", "-", fit.s0, fit.error[0], samples, why});
    m.push_back({"s1", "-", fit.s1, fit.error[1], samples, why});
    if (alpha) {
        m.push_back({"alpha", "-", fit.alpha, std::nullopt, samples, "fixed, not fitted"});
    } else {
        m.push_back({"alpha", "-", fit.alpha, fit.error[2], samples, why});
    }
    m.push_back({"k_fit", "1/a", fit.k_max, std::nullopt, 0, "end of the range of the fit"});
    if (const auto interval = ratio_interval(spectrum, fit)) {
        const char* meaning = "end of the 68 % interval";
        m.push_back({"s0_over_s1_low", "-", interval->low, std::nullopt, samples, meaning});
        m.push_back({"s0_over_s1_high", "-", interval->high, std::nullopt, samples, meaning});
    }
    const int free = fit.points - (alpha ? 2 : 3);
    if (free > 0) {
        m.push_back({"chi2_per_dof", "-", fit.chi2 / free, std::sqrt(2.0 / free),
                     static_cast<double>(free), "about one if the form describes S(k)"});
    }
    result.curves = {drawn(fit, spectrum.k.front(), sk.find_curve("sk")->find("k")->unit)};
    return result;
}

}  // namespace grainfield::analysis
