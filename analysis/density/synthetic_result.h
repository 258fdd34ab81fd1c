#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/spectra/structure_factor.h"
#include "analysis/statistics/spectrum_fit.h"
#include "core/option_table.h"
#include "core/results.h"

namespace grainfield::analysis {

/// Which S(k) the synthetic variance is made from.
enum class SpectrumSource {
    measured,  ///< the fit up to its end, the measured shells above
    fit        ///< the fit alone, continued to where it reaches one
};

struct SyntheticOptions {
    std::optional<std::vector<double>> sides{};  ///< of the boxes [a], inf among them; else: below
    SpectrumSource spectrum = SpectrumSource::measured;
    double largest = 10000;  ///< largest window in an infinite box [a]
};

OptionTable describe(SyntheticOptions& options);

/// What the synthetic variance needs of a run.
struct SyntheticInput {
    Spectrum spectrum;     ///< as the fit took it
    ObservableResult fit;  ///< the observable "fit"
    double density = 0;    ///< particles (content of a field: volume) per area [1/a²]
    bool is_field = false;
    double side = 0;       ///< of the box, sqrt(area) if it is not square [a]
    std::string reason{};  ///< why nothing can be computed; empty: nothing speaks against it
};

/// Of a run whose S(k) is at hand. A field counts its volume as particles: density 1.
SyntheticInput synthetic_input(const StructureFactor& sk, const ObservableResult& fit);

/// The observable "synthetic": number variance σ²(ℓ) of other boxes than the measured one, from its
/// S(k) (analysis/density/synthetic_variance.h): curve `synthetic` with columns l, side (text: the
/// number or "inf"), variance, err, mean, beyond. Boxes are periodic and always hold the same
/// number of particles, so that σ² = 0 at ℓ = L. Without `sides`: the side of the measured box, ten
/// times it, and inf. Below the lowest measured k there is the fit only: without one, no box is
/// larger than the measured one; nor any box if the lowest shells have no error. Where the shells
/// end S = 1 is taken (of a field: the last value); `beyond` is what of the variance comes from
/// there. err: from the errors of S0, S1 and the shells, and the whole of `beyond`; missing where
/// S0 or S1 has none. Windows whose variance would be negative (S0 < 0) are left out, with a
/// reason.
///
/// Measurement crossover_length: ℓ* = 2π a (S0/S1)^(−1/α), above which the S0 term rules
/// (`castillo2019`), error of first order, by the errors of S0/S1 and of α without their
/// covariance. Throws OptionError for sides that are not positive numbers or inf.
ObservableResult synthetic_result(const SyntheticInput& input, const SyntheticOptions& options);

}  // namespace grainfield::analysis
