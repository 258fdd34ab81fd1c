#include "analysis/spectra/fit_result.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/recorded_options.h"
#include "analysis/statistics/blocks.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

using Estimator = StructureFactor::Estimator;

constexpr std::size_t least_blocks = 8;
constexpr double least_particles = 25;
constexpr double growth_end = 0.5;  // [1/a] where the fit has no range, as of S4

std::optional<double> alpha_of(const FitOptions& options) {
    if (options.exponent == Exponent::free) return std::nullopt;
    return options.alpha;
}

// The end of the range and the pre-peak it comes from.
struct Range {
    std::optional<double> end;
    PrePeak peak;
};

Range range_of(const Spectrum& spectrum, const FitOptions& options) {
    Range range{options.k_max, find_pre_peak(spectrum)};
    if (!range.end && range.peak.k) range.end = options.range * *range.peak.k;
    return range;
}

SpectrumFit fit_of(const Spectrum& spectrum, const FitOptions& options) {
    const Range range = range_of(spectrum, options);
    if (range.end) return fit_spectrum(spectrum, *range.end, alpha_of(options), options.method);
    SpectrumFit none;
    none.reason = range.peak.reason + ", which sets the range of the fit; set its end, --fit-k-max";
    return none;
}

// Half the central 68 % of the values; nothing if fewer than half of them are finite.
std::optional<double> half_width(std::vector<double> values, std::size_t wanted) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.size() < std::max<std::size_t>(20, wanted / 2)) return std::nullopt;
    std::ranges::sort(values);
    const auto at = [&](double share) {
        return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    return 0.5 * (at(0.8413) - at(0.1587));
}

struct Bootstrap {
    std::vector<double> s0, s1, ratio, alpha, peak;
};

Bootstrap bootstrap(const StructureFactor& sk, Estimator estimator, const FitOptions& options) {
    Bootstrap values;
    const std::vector<std::size_t> filled = sk.filled_blocks();
    if (filled.size() < least_blocks) return values;
    for (std::int64_t b = 0; b < options.bootstrap; ++b) {
        RandomStream random(0, "fit bootstrap", static_cast<std::uint64_t>(b));
        std::vector<int> times(sk.blocks(), 0);
        for (std::size_t i = 0; i < filled.size(); ++i)
            ++times[filled[random.below(filled.size())]];
        const Spectrum spectrum = sk.spectrum(estimator, times);
        if (const PrePeak peak = find_pre_peak(spectrum); peak.k) values.peak.push_back(*peak.k);
        const SpectrumFit fit = fit_of(spectrum, options);
        if (!fit.ok()) continue;
        values.s0.push_back(fit.s0);
        values.s1.push_back(fit.s1);
        values.ratio.push_back(fit.ratio());
        values.alpha.push_back(fit.alpha);
    }
    return values;
}

Measurement measured(std::string name, const char* unit, double value, std::optional<double> error,
                     double samples, std::string reason) {
    Measurement m{std::move(name), unit, value, error, samples, std::move(reason)};
    if (m.error && !(*m.error > 0)) m.error.reset();
    if (!m.error && m.reason.empty()) m.reason = "no error: too few resamplings have a fit";
    return m;
}

// Why a fit has no S0/S1; empty if it has one.
std::string without_ratio(const SpectrumFit& fit) {
    if (!fit.ok()) return fit.reason;
    return rises(fit.s1, fit.error[1]) ? "" : no_rise(fit.s1, fit.error[1]);
}

std::string systematic_name(const char* what) {
    return std::string("s0_over_s1_systematic_") + what;
}

// Half of what S0/S1 moves by when the fit is made in two other ways.
Measurement systematic(const char* what, const SpectrumFit& a, const SpectrumFit& b,
                       const char* meaning) {
    const std::string name = systematic_name(what);
    for (const SpectrumFit* fit : {&a, &b}) {
        if (std::string why = without_ratio(*fit); !why.empty()) {
            return missing(name, "-", std::move(why));
        }
    }
    return {name, "-", 0.5 * std::abs(a.ratio() - b.ratio()), std::nullopt, 0, meaning};
}

// Every second shell from `first` on.
Spectrum every_second(const Spectrum& spectrum, std::size_t first) {
    Spectrum part;
    for (std::size_t i = first; i < spectrum.k.size(); i += 2) {
        part.k.push_back(spectrum.k[i]);
        part.s.push_back(spectrum.s[i]);
        part.dof.push_back(spectrum.dof[i]);
        part.error.push_back(spectrum.error[i]);
    }
    return part;
}

void add_systematics(const Spectrum& spectrum, const SpectrumFit& fit, const FitOptions& options,
                     ObservableResult& result) {
    const auto at = [&](double k_max, double alpha) {
        return fit_spectrum(spectrum, k_max, alpha, options.method);
    };
    const double end = fit.k_max;
    result.measurements.push_back(systematic("alpha", at(end, 0.97), at(end, 1.27),
                                             "half the change from alpha = 0.97 to 1.27"));
    result.measurements.push_back(systematic("range", at(end * 0.5 / 0.65, fit.alpha),
                                             at(end * 0.8 / 0.65, fit.alpha),
                                             "half the change from 0.77 to 1.23 of the range"));
    const auto half = [&](std::size_t first) {
        return fit_spectrum(every_second(spectrum, first), end, fit.alpha, options.method);
    };
    result.measurements.push_back(systematic(
        "grid", half(0), half(1), "half the difference between every second shell and the others"));
}

Curve fit_curve(const SpectrumFit& fit, double first) {
    Curve curve;
    curve.name = "fit";
    curve.title = fmt::format("S0 + S1 (ka)^{:.3g}", fit.alpha);
    Column k{"k", "1/a", "Wavevector k a", {}};
    Column s{"s", "-", "S(k), fitted", {}};
    Column error{"s_err", "-", "Standard error", {}};
    for (int i = 0; i <= 60; ++i) {
        k.values.push_back(first * std::pow(fit.k_max / first, i / 60.0));
        s.values.push_back(fit.value(k.values.back()));
        error.values.push_back(fit.value_error(k.values.back()));
    }
    curve.columns = {k, s, error};
    return curve;
}

// What a fit is made from.
struct Evidence {
    Spectrum spectrum;
    Bootstrap values{};
    bool resampled = false;  // errors from `values`
    std::size_t blocks = 0;
    // Between walls, of the modes that are not fitted: cosines, or plane waves.
    std::optional<Spectrum> others{};
    std::optional<SpectrumGrowth> growth{};  // of the range

    bool is_steady() const { return !growth || growth->is_steady(); }
};

ObservableResult blank(const FitOptions& options, std::string reason) {
    ObservableResult result;
    result.name = "fit";
    FitOptions copy = options;
    result.options = recorded(describe(copy));
    result.reason = std::move(reason);
    return result;
}

Estimator estimator_of(const StructureFactor& sk, FitModes modes) {
    if (sk.allows(Estimator::neumann) && modes == FitModes::box) return Estimator::neumann;
    return sk.is_periodic() || !sk.allows(Estimator::connected) ? Estimator::raw
                                                                : Estimator::connected;
}

struct FittedError {
    double value = 0;
    std::string remark;
};

// The error of a fitted number: from the resampled blocks, or from the likelihood where there are
// none or few of them have a fit.
FittedError error_of(const Evidence& evidence, const std::vector<double>& resampled,
                     double from_likelihood, const FitOptions& options) {
    if (!evidence.resampled) {
        return {from_likelihood, "error from the likelihood, not from resampled blocks"};
    }
    // Resampling K blocks loses a part 1/K of their variance; the rest is Student's factor.
    const auto k = static_cast<double>(evidence.blocks);
    const auto width = half_width(resampled, static_cast<std::size_t>(options.bootstrap));
    if (!width) {
        return {from_likelihood, "error from the likelihood: too few resamplings have a fit"};
    }
    // So few blocks know the error to a fifth: never less than the likelihood says.
    return {std::max(*width * std::sqrt(k / (k - 3)), from_likelihood), ""};
}

// Whether the curve describes the shells: about 1 where it does.
Measurement chi2_of(const SpectrumFit& fit, const FitOptions& options) {
    const int free = fit.points - (options.exponent == Exponent::free ? 3 : 2);
    if (free <= 0) return missing("chi2_per_dof", "-", "as many shells as parameters");
    return {"chi2_per_dof",
            "-",
            fit.chi2 / free,
            std::sqrt(2.0 / free),
            static_cast<double>(fit.points),
            "whether the curve describes the shells: about 1 where it does"};
}

Measurement pre_peak_of(const Evidence& evidence, double samples, const FitOptions& options) {
    const PrePeak peak = find_pre_peak(evidence.spectrum);
    if (!peak.k) return missing("k_pre_peak", "1/a", peak.reason);
    if (!evidence.is_steady()) {
        return measured("k_pre_peak", "1/a", *peak.k, std::nullopt, samples,
                        "S is not steady: no error");
    }
    const auto wanted = static_cast<std::size_t>(options.bootstrap);
    return measured("k_pre_peak", "1/a", *peak.k, half_width(evidence.values.peak, wanted), samples,
                    evidence.resampled ? "" : "no resampled blocks of time: no error");
}

double samples_up_to(const Spectrum& spectrum, double k_max) {
    double samples = 0;
    for (std::size_t i = 0; i < spectrum.k.size() && spectrum.k[i] <= k_max; ++i) {
        if (std::isfinite(spectrum.dof[i])) samples += spectrum.dof[i];
    }
    return samples;
}

// What is known without a fit: the pre-peak and the growth of S, if there are any.
ObservableResult without_fit(const Evidence& evidence, const FitOptions& options,
                             const std::string& reason) {
    const std::optional<double> peak = find_pre_peak(evidence.spectrum).k;
    if (!peak && !evidence.growth) return blank(options, reason);
    ObservableResult result = blank(options, "");
    for (const char* name : {"s0_over_s1", "s0", "s1", "alpha", "chi2_per_dof"}) {
        result.measurements.push_back(missing(name, "-", reason));
    }
    const double samples = peak ? samples_up_to(evidence.spectrum, *peak) : 0;
    result.measurements.push_back(pre_peak_of(evidence, samples, options));
    if (evidence.growth) result.measurements.push_back(measured_growth("s", *evidence.growth));
    return result;
}

void add_range(const Evidence& evidence, const SpectrumFit& fit, bool has_ratio, double samples,
               const FitOptions& options, ObservableResult& result) {
    auto& m = result.measurements;
    m.push_back(pre_peak_of(evidence, samples, options));
    m.push_back({"k_fit", "1/a", fit.k_max, std::nullopt, 0,
                 fmt::format("end of the fit; chi2 = {:.4g} for {} shells", fit.chi2, fit.points)});
    const auto interval = has_ratio ? ratio_interval(evidence.spectrum, fit) : std::nullopt;
    if (interval) {
        const char* meaning = "end of the 68 % profile-likelihood interval";
        m.push_back({"s0_over_s1_low", "-", interval->low, std::nullopt, 0, meaning});
        m.push_back({"s0_over_s1_high", "-", interval->high, std::nullopt, 0, meaning});
    }
    m.push_back({"s0_s1_correlation", "-", fit.covariance / (fit.error[0] * fit.error[1]),
                 std::nullopt, 0, "of the errors of S0 and S1, from the likelihood"});
}

ObservableResult fit_of_evidence(const Evidence& evidence, const FitOptions& options) {
    if (!evidence.is_steady()) {
        return without_fit(evidence, options, not_steady("S", *evidence.growth));
    }
    const SpectrumFit fit = fit_of(evidence.spectrum, options);
    if (!fit.ok()) return without_fit(evidence, options, fit.reason);
    ObservableResult result = blank(options, "");
    const Spectrum& spectrum = evidence.spectrum;
    const Bootstrap& values = evidence.values;
    const auto fitted = [&](const char* name, double value, const std::vector<double>& resampled,
                            double from_likelihood, double samples) {
        FittedError error = error_of(evidence, resampled, from_likelihood, options);
        return measured(name, "-", value, error.value, samples, std::move(error.remark));
    };
    const double samples = samples_up_to(spectrum, fit.k_max);
    auto& m = result.measurements;
    const Measurement s1 = fitted("s1", fit.s1, values.s1, fit.error[1], samples);
    const double s1_error = s1.error.value_or(std::numeric_limits<double>::quiet_NaN());
    const std::string why = rises(fit.s1, s1_error) ? "" : no_rise(fit.s1, s1_error);
    m.push_back(why.empty()
                    ? fitted("s0_over_s1", fit.ratio(), values.ratio, fit.ratio_error(), samples)
                    : missing("s0_over_s1", "-", why));
    m.push_back(fitted("s0", fit.s0, values.s0, fit.error[0], samples));
    m.push_back(s1);
    if (options.exponent == Exponent::free) {
        m.push_back(fitted("alpha", fit.alpha, values.alpha, fit.error[2], samples));
    } else {
        m.push_back({"alpha", "-", fit.alpha, std::nullopt, 0, "given, not fitted"});
    }
    add_range(evidence, fit, why.empty(), samples, options, result);
    m.push_back(chi2_of(fit, options));
    if (evidence.growth) m.push_back(measured_growth("s", *evidence.growth));
    if (evidence.others) {
        const bool plane = options.modes == FitModes::box;
        const char* name = plane ? "s0_over_s1_connected" : "s0_over_s1_neumann";
        const char* meaning = plane ? "plane waves, which leak; error from the likelihood"
                                    : "modes that fit between the walls; error from the likelihood";
        const SpectrumFit other =
            fit_spectrum(*evidence.others, fit.k_max, fit.alpha, options.method);
        const std::string none = without_ratio(other);
        m.push_back(none.empty()
                        ? measured(name, "-", other.ratio(), other.ratio_error(), samples, meaning)
                        : missing(name, "-", none));
    }
    if (why.empty()) {
        add_systematics(spectrum, fit, options, result);
    } else {
        for (const char* what : {"alpha", "range", "grid"}) {
            m.push_back(missing(systematic_name(what), "-", why));
        }
    }
    result.curves = {fit_curve(fit, spectrum.k.front())};
    return result;
}

}  // namespace

OptionTable describe(FitOptions& options) {
    OptionTable table("fit");
    table.choice("exponent", options.exponent,
                 {{"fixed", Exponent::fixed}, {"free", Exponent::free}},
                 "whether alpha is given or fitted");
    table.number("alpha", options.alpha, "-", {0.2, 4}, "the exponent where it is fixed");
    table.number("range", options.range, "-", {0.05, 1},
                 "end of the fit as a part of the wavevector of the pre-peak");
    table.number("k-max", options.k_max, "1/a", {1e-9, 1e9},
                 "end of the fit; auto: range times the wavevector of the pre-peak");
    table.choice("method", options.method,
                 {{"whittle", FitMethod::whittle}, {"least-squares", FitMethod::least_squares}},
                 "gamma likelihood, or weights from the measured errors");
    table.choice("modes", options.modes,
                 {{"box", FitModes::box}, {"plane-waves", FitModes::plane_waves}},
                 "of the box: cosines between hard walls; or plane waves, which leak there");
    table.integer("bootstrap", options.bootstrap, "-", {0, 100000},
                  "resamplings of the blocks of time for the errors");
    return table;
}

FitModes recorded_modes(const ObservableResult& fit) {
    const OptionValue* modes = fit.find_option("modes");
    return modes != nullptr && to_text(*modes) == "plane-waves" ? FitModes::plane_waves
                                                                : FitModes::box;
}

Spectrum recorded_spectrum(const ObservableResult& sk, FitModes modes) {
    const bool walls = modes == FitModes::box && sk.find_curve("sk_neumann") != nullptr;
    const Curve* s = sk.find_curve(walls ? "sk_neumann" : "sk");
    const Curve* samples = sk.find_curve(walls ? "sk_neumann_samples" : "sk_samples");
    const Column* dof = samples == nullptr ? nullptr : samples->find("dof");
    if (s == nullptr || dof == nullptr) return {};
    const Column* k = s->find("k");
    const Column* value = s->find("s");
    const Column* error = s->find("s_err");
    if (k == nullptr || value == nullptr || error == nullptr) return {};
    if (dof->values.size() != k->values.size()) return {};
    return {k->values, value->values, dof->values, error->values};
}

std::string why_no_fit(const ObservableResult& fit) {
    const Measurement* s0 = fit.find_measurement("s0");
    return s0 != nullptr && !s0->value ? s0->reason : fit.reason;
}

Spectrum fitted_spectrum(const StructureFactor& sk, FitModes modes) {
    return sk.spectrum(estimator_of(sk, modes));
}

ObservableResult fit_result(const Spectrum& spectrum, const FitOptions& options) {
    if (spectrum.k.empty()) return blank(options, "no S(k) with its degrees of freedom to fit");
    return fit_of_evidence({.spectrum = spectrum}, options);
}

ObservableResult fit_result(const StructureFactor& sk, const FitOptions& options) {
    const bool walls = !sk.is_periodic();
    if (!sk.allows(Estimator::raw) || (walls && !sk.allows(Estimator::connected))) {
        return blank(options, walls ? "one frame: S(k) has the walls in it" : "no S(k) to fit");
    }
    if (sk.counts_particles() && sk.particles_mean() < least_particles) {
        return blank(options, fmt::format("{:.3g} particles a frame: density modes are Gaussian "
                                          "from some {:.0f} on",
                                          sk.particles_mean(), least_particles));
    }
    const Estimator fitted = estimator_of(sk, options.modes);
    Evidence evidence{.spectrum = sk.spectrum(fitted)};
    evidence.blocks = sk.filled_blocks().size();
    evidence.resampled = evidence.blocks >= least_blocks && options.bootstrap >= 40;
    if (sk.allows(Estimator::neumann)) {
        evidence.others =
            sk.spectrum(fitted == Estimator::neumann ? Estimator::connected : Estimator::neumann);
    }
    const Range range = range_of(evidence.spectrum, options);
    const double end = range.end ? std::max(*range.end, range.peak.k.value_or(0)) : growth_end;
    evidence.growth = sk.growth(fitted, end);
    if (range.end && evidence.is_steady()) evidence.values = bootstrap(sk, fitted, options);
    return fit_of_evidence(evidence, options);
}

}  // namespace grainfield::analysis
