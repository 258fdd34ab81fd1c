#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec2.h"
#include "tracking/refine/joint_covariance.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/refine/joint_information.h"

namespace grainfield::tracking {

/// The joint Newton steps of a fit, and the information matrix that they keep.
///
/// All positions are displaced at once by d = A⁻¹ b (joint_information.h). The matrix is summed
/// anew, or after a step in which few discs moved far updated beside these alone.
class JointSolver {
 public:
    /// Puts discs on an empty fit and sums the information about all of them in the same pass.
    void place_all(JointFit& fit, const std::vector<Vec2>& positions,
                   const std::vector<double>& explained, std::optional<double> left);

    struct StepLimits {
        double accuracy;     ///< of the solution [px]
        double least_drawn;  ///< shorter steps stay pending [px]
        double far;          ///< longer ones are not the last [px]
    };
    struct StepCount {
        std::int64_t discs = 0;     ///< whose normal equations were summed
        std::int64_t went_far = 0;  ///< how many stepped farther than `far`
    };
    /// One step of a series; after the first one, discs that go far are restless.
    StepCount step(JointFit& fit, const StepLimits& limits, bool is_first);

    /// Sums the information if discs came or went since the last step.
    void complete(const JointFit& fit);
    /// By how much pending steps lower the misfit about each disc [contrast²].
    std::vector<double> gain(const JointFit& fit) const { return pending_gain(fit, information_); }
    /// Of unit noise [px²].
    std::vector<PositionCovariance> covariance(int threads) const {
        return joint_covariance(information_, threads);
    }

 private:
    JointInformation information_;
    std::uint64_t arrangement_ = 0;               ///< of the fit that it is about
    std::int64_t went_far_ = 0, far_before_ = 0;  ///< in the last step, in the one before
    /// Of the discs as placed, and the revision of the fit then.
    std::optional<JointInformation> placed_;
    std::uint64_t placed_revision_ = 0;
};

}  // namespace grainfield::tracking
