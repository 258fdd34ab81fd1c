#pragma once

#include <cstdint>

#include "tracking/detect/disc_correlation.h"
#include "tracking/detect/residual_blocks.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

struct SecondLook {
    std::int64_t trials = 0;  ///< discs added
    std::int64_t kept = 0;    ///< … that stayed
    std::int64_t steps = 0;   ///< disc updates done
};

/// Looks again where the model of all discs leaves unusually much unexplained.
///
/// Around a sphere that is missing, or taken for one where there are two, the neighbours settle so
/// that one more disc explains little *while they stay where they are*. The likelihood gain says no
/// more than that. So it is tried. Where Σ (I − M)² over a square of three reaches is unusual
/// (above its median m over all discs by m/2, or by four robust standard deviations if that is
/// less) a disc is added at the highest gain that has not been tried. It and its neighbours take a
/// few sweeps. It stays if the misfit within 1.75 D falls by a share of m less the camera's noise
/// in it, and by 36 σ² at least. That share is `evidence` over 0.12, and two thirds at least. Else
/// it goes and its neighbours go back. Trials 5 D apart are made at once, in eight rounds at most.
///
/// A frame without such places in `residual`, less the gain of pending steps, costs
/// nothing; else all discs are drawn where they are. `separation`: none stays nearer to
/// another disc [px]; `noise` σ [contrast]; `evidence`: share of an isolated disc's misfit that
/// each must explain. `refinement`: tolerance of the sweeps, and their number if less than twelve.
/// The rows of the fit are those of the image (spacing 1). Independent of the number of threads.
SecondLook look_again(JointFit& fit, DiscCorrelation& correlation, double separation, double noise,
                      double evidence, const RefinementOptions& refinement,
                      const ResidualBlocks& residual);

}  // namespace grainfield::tracking
