#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// The normal equations of all positions at once, A d = b:
///
///   A_ij = Σ_x J_i J_jᵀ,   b_i = Σ_x J_i (I − M),   J_i = ∂M/∂(x_i, y_i).
///
/// Blocks A_ij are summed for pairs nearer than D + 2.5w and kept where they matter (squared
/// coupling above 1e-4). Discs that are all but hidden (smallest eigenvalue of A_ii below 1e-6 of
/// an isolated disc's) are coupled to nobody.
struct JointInformation {
    struct Entry {
        std::uint32_t other;
        CrossBlock block;  ///< A_i,other [1/px²]
    };
    std::vector<NormalEquations> own;  ///< A_ii and b_i
    std::vector<char> is_hidden;
    std::vector<std::size_t> begin;  ///< of the entries of each disc; one more at the end
    std::vector<Entry> entry;
};

/// As the discs are drawn now. In parallel; independent of the number of threads. About 1 µs a disc
/// in a liquid at D = 16 px.
JointInformation joint_information(const JointFit& fit, int threads);

/// The same after a step, with the couplings of before: A_ii and b_i are summed anew for those
/// disturbed, b_i of the others is zero since they have taken their step.
void update_information(const JointFit& fit, int threads, const std::vector<char>& disturbed,
                        JointInformation& information);

/// Where all discs together want to go from where they are drawn: d = A⁻¹ b, by Gauss–Seidel sweeps
/// over the blocks until no disc changes by more than `accuracy` [px]. No pixel is touched.
struct JointStep {
    std::vector<Vec2> step;   ///< d [px]
    std::vector<float> left;  ///< the last change of each [px]
};
JointStep joint_step(const JointInformation& information, double accuracy);

}  // namespace grainfield::tracking
