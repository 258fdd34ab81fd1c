#pragma once

#include <span>
#include <vector>

#include "core/results.h"

namespace grainfield::analysis {

/// S of consecutive stretches of time at one wavevector, in order.
struct WaveSamples {
    double k = 0;  ///< |k| [1/l]
    std::vector<double> s;
};

/// The observable "sk" from the samples of the adjoint estimator (docs/field/schemes.md). Waves of
/// one length are pooled. They share the order field, and stretches shorter than its correlation
/// time are not independent of one another: the error comes from blocks of time that hold all waves
/// of a length,
///
///   K = min(16, fewest stretches of a wave, `correlation_times`) blocks,
///
/// jackknife over them times sqrt((K − 1)/(K − 3)), the spread of Student's t. With K < 4 there is
/// no error, and a reason. `correlation_times`: how often 1/ν fits into the run.
ObservableResult adjoint_spectrum(std::span<const WaveSamples> waves, double correlation_times);

}  // namespace grainfield::analysis
