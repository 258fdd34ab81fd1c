#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/vec2.h"
#include "tracking/disc_profile.h"

namespace grainfield::tracking {

struct RefinementOptions {
    double tolerance = 0.003;  ///< [px] a disc rests when its step is smaller
    int max_sweeps = 150;      ///< most sweeps over the discs in one refinement
};

OptionTable describe(RefinementOptions& options);

/// All discs of one frame and the image that they make together.
///
/// Least squares on the product of transmissions, M = 1 − Π_j (1 − P_j), over all positions at
/// once: Gauss–Seidel sweeps of damped 2×2 Gauss–Newton steps, each disc against the present image
/// of all others. A step that raises the local misfit is shortened. Discs whose neighbourhood rests
/// are skipped. Fixed points are those of the joint problem.
///
/// Tiles of four colours are swept colour by colour, discs of a tile in order of index: the result
/// does not depend on the number of threads. Cost about 2 µs per disc and sweep at D = 10 px.
class JointFit {
 public:
    /// `darkness` must outlive the fit.
    JointFit(const Image& darkness, const DiscProfile& disc, int threads);

    void add(Vec2 position);
    /// Removes the discs whose entry in `keep` is zero.
    void keep_only(const std::vector<char>& keep);

    struct Summary {
        int sweeps = 0;
        std::int64_t steps = 0;      ///< disc updates done
        std::int64_t skipped = 0;    ///< disc updates left out because the neighbourhood rested
        std::int64_t unsettled = 0;  ///< discs still moving when max_sweeps ended it
    };
    Summary refine(const RefinementOptions& options);

    const std::vector<Vec2>& positions() const { return positions_; }
    const Image& transmission() const { return transmission_; }
    const DiscProfile& disc() const { return disc_; }

    /// Σ (I − M)² that each disc explains (see explained_misfit), in parallel.
    std::vector<double> explained() const;

    struct Uncertainty {
        Vec2 error;       ///< [px] conditional standard error for unit noise: times σ gives pixels
        double residual;  ///< RMS of I − M over the window [contrast]
    };
    std::vector<Uncertainty> uncertainties() const;

    /// RMS of I − M over the frame [contrast].
    double residual_rms() const;

 private:
    double longest_step() const;
    Vec2 step(std::size_t j, double relaxation);
    void sweep(const std::vector<char>& active, double relaxation);
    std::vector<char> active_discs(double tolerance) const;

    const Image* darkness_;
    DiscProfile disc_;
    int threads_;
    Image transmission_;
    std::vector<Vec2> positions_;
    std::vector<float> last_step_;  ///< [px]; large for discs that have not moved yet
};

}  // namespace grainfield::tracking
