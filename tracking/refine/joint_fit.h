#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/vec2.h"
#include "tracking/disc_profile.h"
#include "tracking/padded_image.h"
#include "tracking/refine/disc_kernel.h"

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
/// does not depend on the number of threads. Cost about 1 µs per disc and sweep at D = 16 px.
class JointFit {
 public:
    JointFit(const Image& darkness, const DiscProfile& disc, int threads);

    /// `explained`: what the disc is known to explain, until something near it moves.
    void add(Vec2 position, std::optional<double> explained = {});
    void move(std::size_t j, Vec2 to);
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
    /// How far each disc moved in its last step [px]; 0 once its neighbourhood rested.
    const std::vector<float>& last_steps() const { return last_step_; }
    const PaddedImage& darkness() const { return darkness_; }
    const PaddedImage& transmission() const { return transmission_; }
    const DiscProfile& disc() const { return disc_; }

    /// Σ (I − M)² that each disc explains (see explained_misfit). Discs in whose neighbourhood
    /// nothing has moved by more than 0.05 px since the last call keep their value.
    const std::vector<double>& explained();

    /// RMS of I − M within reach of each disc [contrast].
    std::vector<double> residuals() const;

    /// RMS of I − M over the frame [contrast].
    double residual_rms() const;

 private:
    Vec2 step(std::size_t j, double relaxation);
    void sweep(const std::vector<char>& active, double relaxation);
    std::vector<char> active_discs(double tolerance) const;

    DiscProfile disc_;
    int threads_;
    PaddedImage darkness_;
    PaddedImage transmission_;
    std::vector<Vec2> positions_;
    std::vector<float> last_step_;   ///< [px]; large for discs that have not moved yet
    std::vector<double> explained_;  ///< as of the last call of explained()
    std::vector<float> drift_;       ///< [px] path since then; large for new discs
};

}  // namespace grainfield::tracking
