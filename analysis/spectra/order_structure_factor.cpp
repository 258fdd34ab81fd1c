#include "analysis/spectra/order_structure_factor.h"

#include <cmath>
#include <utility>

#include "analysis/recorded_options.h"
#include "analysis/statistics/blocks.h"
#include "analysis/statistics/ornstein_zernike.h"

namespace grainfield::analysis {
namespace {

Curve renamed(Curve curve, const char* name) {
    curve.name = name;
    return curve;
}

Curve drawn(const OrnsteinZernikeFit& fit, double k_first) {
    constexpr int points = 60;
    std::vector<double> k, s;
    for (int i = 0; i < points; ++i) {
        k.push_back(k_first * std::pow(fit.k_max / k_first, i / (points - 1.0)));
        s.push_back(fit.value(k.back()));
    }
    Curve curve{
        .name = "s4_fit", .title = "Ornstein–Zernike fit", .columns = {}, .text_columns = {}};
    curve.columns = {{"k", "1/a", "Wavevector k a", k}, {"s", "-", "S4(0)/(1 + (ξ4 k)²)", s}};
    return curve;
}

}  // namespace

OptionTable describe(OrderStructureFactorOptions& options) {
    OptionTable table = describe(options.modes, "s4");
    table.number("fit-k-max", options.fit_k_max, "1/a", {1e-9, 1e9},
                 "end of the Ornstein-Zernike fit");
    return table;
}

OrderStructureFactor::OrderStructureFactor(const OrderStructureFactorOptions& options,
                                           const Box& box, std::int64_t frames, std::int64_t first)
    : options_(options), modes_(StructureFactor::of_order(options.modes, box, frames, first)) {}

ObservableResult OrderStructureFactor::result() const {
    const ObservableResult modes = modes_.result();
    ObservableResult result;
    result.name = "s4";
    OrderStructureFactorOptions options = options_;
    result.options = recorded(describe(options));
    result.reason = modes.reason;
    if (!result.reason.empty()) return result;

    result.curves.push_back(renamed(*modes.find_curve("sk"), "s4"));
    if (const Curve* samples = modes.find_curve("sk_samples")) {
        result.curves.push_back(renamed(*samples, "s4_samples"));
    }
    const bool connected =
        !modes_.is_periodic() && modes_.allows(StructureFactor::Estimator::connected);
    const auto best =
        connected ? StructureFactor::Estimator::connected : StructureFactor::Estimator::raw;
    const Spectrum spectrum = modes_.spectrum(best);
    const auto growth = modes_.growth(best, options_.fit_k_max);
    OrnsteinZernikeFit fit;
    if (growth && !growth->is_steady()) {
        fit.reason = not_steady("S4", *growth);
    } else {
        fit = fit_ornstein_zernike(spectrum, options_.fit_k_max);
    }
    if (fit.ok()) {
        double samples = 0;
        for (std::size_t i = 0; i < spectrum.k.size() && spectrum.k[i] <= fit.k_max; ++i) {
            samples += spectrum.dof[i];
        }
        result.measurements.push_back({"s4_zero", "-", fit.s_zero, fit.s_zero_error, samples, ""});
        result.measurements.push_back({"xi4", "a", fit.xi, fit.xi_error, samples, ""});
        result.measurements.push_back({"chi2_per_dof", "-", fit.chi2_per_dof, std::nullopt,
                                       static_cast<double>(fit.points),
                                       "of the Ornstein–Zernike fit; much above 1: another form"});
        result.curves.push_back(drawn(fit, spectrum.k.front()));
    } else {
        result.measurements.push_back(missing("s4_zero", "-", fit.reason));
        result.measurements.push_back(missing("xi4", "a", fit.reason));
    }
    if (growth) result.measurements.push_back(measured_growth("s4", *growth));
    for (Measurement m : modes.measurements) {
        if (m.name != "s_lowest_k" && m.name != "lowest_k") continue;
        if (m.name == "s_lowest_k") m.name = "s4_lowest_k";
        result.measurements.push_back(std::move(m));
    }
    return result;
}

}  // namespace grainfield::analysis
