#include "tracking/refine/joint_solver.h"

#include <algorithm>
#include <utility>

namespace grainfield::tracking {
namespace {

// An update keeps the couplings of before. Where many discs have gone far in a crystal, the matrix
// is then no longer positive, and joint steps diverge. Nor is there an update where more discs
// went far than in the step before.
constexpr double kMostFar = 0.28;  // of all discs
// Where most are disturbed an update costs as much as all sums anew.
constexpr double kMostDisturbed = 0.5;

}  // namespace

void JointSolver::place_all(JointFit& fit, const std::vector<Vec2>& positions,
                            const std::vector<double>& explained, std::optional<double> left) {
    placed_ = add_all(fit, positions, explained, left);
    placed_revision_ = fit.revision();
}

JointSolver::StepCount JointSolver::step(JointFit& fit, const StepLimits& limits, bool is_first) {
    const std::vector<char> disturbed = fit.collect_disturbed();
    const auto discs = static_cast<std::int64_t>(disturbed.size());
    StepCount count;
    count.discs = std::count(disturbed.begin(), disturbed.end(), 1);
    const bool is_update =
        arrangement_ == fit.arrangement() && went_far_ <= far_before_ &&
        static_cast<double>(went_far_) <= kMostFar * static_cast<double>(discs) &&
        static_cast<double>(count.discs) <= kMostDisturbed * static_cast<double>(discs);
    if (is_update) {
        update_information(fit, disturbed, information_);
    } else {
        const bool is_known = placed_ && placed_revision_ == fit.revision();
        information_ = is_known ? *std::exchange(placed_, {}) : joint_information(fit);
        arrangement_ = fit.arrangement();
        count.discs = discs;
    }
    far_before_ = is_first ? discs : went_far_;
    count.went_far = went_far_ = fit.displace(joint_step(information_, limits.accuracy),
                                              limits.least_drawn, limits.far, !is_first);
    return count;
}

void JointSolver::complete(const JointFit& fit) {
    if (arrangement_ == fit.arrangement()) return;
    information_ = joint_information(fit);
    arrangement_ = fit.arrangement();
}

}  // namespace grainfield::tracking
