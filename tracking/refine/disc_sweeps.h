#pragma once

#include <cstdint>

#include "core/option_table.h"
#include "tracking/model/binning.h"
#include "tracking/refine/fitted_discs.h"
#include "tracking/refine/stencil_view.h"

namespace grainfield::tracking {

struct RefinementOptions {
    double tolerance = 0.003;  ///< [px] a disc rests when its step is smaller
    int max_sweeps = 150;      ///< most sweeps over the discs in one refinement
};

OptionTable describe(RefinementOptions& options);

/// The same of frames seen by blocks.
RefinementOptions in_blocks(RefinementOptions options, Binning blocks);

struct SweepSummary {
    int sweeps = 0;
    std::int64_t steps = 0;      ///< disc updates done
    std::int64_t skipped = 0;    ///< disc updates left out because the neighbourhood rested
    std::int64_t unsettled = 0;  ///< discs still moving when max_sweeps ended it
};

/// Gauss–Seidel sweeps of damped 2×2 Gauss–Newton steps, each disc against the present image of all
/// others.
///
/// A step that raises the local misfit is shortened. A disc rests when its next step, judged from
/// how the last two shrank, would be below the tolerance. Discs whose neighbourhood rests are
/// skipped; a step below the tolerance moves the position and stays pending. Tiles of four colours
/// are swept colour by colour, discs of a tile in order of index, each tile several times while it
/// is in the cache: the result does not depend on the number of threads. About 1 µs per disc and
/// sweep at D = 16 px.
SweepSummary sweep(FittedDiscs& discs, const RefinementOptions& options, Drawing drawing);

/// (A + λ)⁻¹ of one disc, λ = 1e-3 (tr A + 1): a Gauss–Newton step is its product with b. A fully
/// hidden disc has no information and stays where it is.
struct DampedInverse {
    double xx, xy, yy;  ///< [px²]

    explicit DampedInverse(const NormalEquations& information);
    Vec2 operator*(Vec2 b) const { return {xx * b.x + xy * b.y, xy * b.x + yy * b.y}; }
};

}  // namespace grainfield::tracking
