#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "analysis/spectra/structure_factor.h"
#include "core/option_table.h"

namespace grainfield::analysis {

enum class Exponent { fixed, free };

/// Which modes are fitted.
enum class FitModes {
    box,         ///< those of the box: plane waves if it is periodic, cosines between hard walls
    plane_waves  ///< also between walls, where they leak: as in `castillo2019`
};

struct FitOptions {
    Exponent exponent = Exponent::fixed;
    double alpha = 1.12;            ///< of a fixed exponent [-]
    double range = 0.65;            ///< end of the range over the wavevector of the pre-peak [-]
    std::optional<double> k_max{};  ///< end of the range [1/a]; auto: range × pre-peak
    FitMethod method = FitMethod::whittle;
    FitModes modes = FitModes::box;
    std::int64_t bootstrap = 200;  ///< resamplings of the blocks of time [-]
};

OptionTable describe(FitOptions& options);

/// The observable "fit": S(k) = S0 + S1 (ka)^α over 0 < k ≤ 0.65 k_pp, k_pp the wavevector of the
/// pre-peak (`castillo2019`; analysis/statistics/spectrum_fit.h for the likelihood).
///
/// Between walls the modes that fit between them are used (sk_neumann), because plane waves leak.
/// The fit of the connected estimator stands beside it. With plane waves selected it is the other
/// way round, to compare with measurements made with them. Measurements: s0_over_s1, s0, s1, alpha,
/// k_pre_peak, k_fit, s_growth; s0_over_s1_low and _high, the profile-likelihood interval (68 %);
/// s0_over_s1_connected or s0_over_s1_neumann; s0_s1_correlation, that of the errors of S0 and S1;
/// and the systematics of s0_over_s1: half of what it moves by for α = 0.97 and 1.27, for ranges of
/// 0.5 and 0.8 k_pp (0.77 and 1.23 of a given range), and by leaving out every second shell. Curve
/// "fit": k, s, s_err.
///
/// Measured from the blocks of time, `s_growth` tells whether S up to the end of the range, and up
/// to the pre-peak, is steady (StructureFactor::growth). Without a range it is told up to ka = 0.5.
/// If S is not steady, S0/S1, S0, S1, α and χ² are missing, with that reason. So they are where
/// there is no fit although the pre-peak or the growth is known. The pre-peak is given in both
/// cases, without an error where S is not steady. With nothing at all the observable has the
/// reason.
///
/// S0/S1 is missing, with the reason, unless S1 is above two of its errors (`rises`): it may be
/// anything there. Its systematics are missing with it, and its interval is left out.
///
/// Errors: half the central 68 % of `bootstrap` resamplings of the K blocks of time, the pre-peak
/// searched anew in each, times sqrt(K/(K − 3)) for the small number of blocks, and never less than
/// the error from the likelihood (blocks alone gave pulls 1.16 wide). With fewer than eight blocks
/// it is from the likelihood, which is said. Cost: (bootstrap + 1) × modes × blocks.
///
/// Below 25 particles a frame there is a reason and no fit: the density modes are then not the
/// Gaussian numbers that the likelihood takes them for.
ObservableResult fit_result(const StructureFactor& sk, const FitOptions& options);

/// The same for a spectrum that was measured before; errors from the likelihood.
ObservableResult fit_result(const Spectrum& spectrum, const FitOptions& options);

/// The spectrum behind an observable "sk" as it is stored, of these modes if there are any. Empty
/// if its curves lack the degrees of freedom (`sk_samples`).
Spectrum recorded_spectrum(const ObservableResult& sk, FitModes modes = FitModes::box);

/// The modes that a stored observable "fit" was made of.
FitModes recorded_modes(const ObservableResult& fit);

/// Why an observable "fit" has no S0 and S1; empty if it has.
std::string why_no_fit(const ObservableResult& fit);

/// The spectrum that `fit_result` takes.
Spectrum fitted_spectrum(const StructureFactor& sk, FitModes modes);

}  // namespace grainfield::analysis
