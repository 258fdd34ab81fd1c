#include "tracking/refine/joint_solver.h"

#include <algorithm>
#include <utility>

namespace grainfield::tracking {
namespace {

// An update keeps the couplings of before. Where many discs have gone far in a crystal, the matrix
// is then no longer positive, and joint steps diverge.
constexpr double kMostFar = 0.28;  // of all discs

}  // namespace

void JointSolver::place_all(JointFit& fit, const std::vector<Vec2>& positions,
                            const std::vector<double>& explained, std::optional<double> left) {
    placed_ = add_all(fit, positions, explained, left);
    placed_revision_ = fit.revision();
}

JointSolver::StepCount JointSolver::step(JointFit& fit, const StepLimits& limits, bool is_first) {
    const std::vector<char> disturbed = fit.collect_disturbed();
    const auto discs = static_cast<std::int64_t>(disturbed.size());
    const bool is_update = !is_first &&
                           static_cast<std::int64_t>(information_.own.size()) == discs &&
                           static_cast<double>(went_far_) <= kMostFar * static_cast<double>(discs);
    StepCount count;
    if (is_update) {
        update_information(fit, disturbed, information_);
        count.discs = std::count(disturbed.begin(), disturbed.end(), 1);
    } else {
        const bool is_known = placed_ && placed_revision_ == fit.revision();
        information_ = is_known ? *std::exchange(placed_, {}) : joint_information(fit);
        count.discs = discs;
    }
    count.went_far = went_far_ = fit.displace(joint_step(information_, limits.accuracy),
                                              limits.least_drawn, limits.far, !is_first);
    return count;
}

void JointSolver::complete(const JointFit& fit) {
    if (information_.own.size() != fit.positions().size()) information_ = joint_information(fit);
}

}  // namespace grainfield::tracking
