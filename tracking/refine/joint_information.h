#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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
/// an isolated disc's) have no couplings.
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

/// As the discs are drawn now. In parallel; the same bits for any number of threads. About 1 µs a
/// disc in a liquid at D = 16 px.
JointInformation joint_information(const JointFit& fit);

/// The same of discs that are added to an empty fit (JointFit::add_all), in one pass over the
/// image: half of the time of one after the other.
JointInformation add_all(JointFit& fit, const std::vector<Vec2>& positions,
                         const std::vector<double>& explained, std::optional<double> left);

/// The same after a step, with the couplings of before. A_ii and b_i are summed anew for those
/// disturbed (JointFit::collect_disturbed). The others have taken their step: b_i = Σ_j A_ij u_j,
/// u_j the pending step (JointFit::pending_step).
void update_information(const JointFit& fit, const std::vector<char>& disturbed,
                        JointInformation& information);

/// By how much the misfit about each disc would fall if pending steps were drawn, u_i · Σ_j A_ij
/// u_j [contrast²]: to second order in w, shared pixels counted once.
std::vector<double> pending_gain(const JointFit& fit, const JointInformation& information);

/// The joint step from where discs are drawn: d = A⁻¹ b, by Gauss–Seidel sweeps over the blocks
/// until no disc changes by more than `accuracy` [px]. No pixel is touched.
JointFit::Displacement joint_step(const JointInformation& information, double accuracy);

}  // namespace grainfield::tracking
