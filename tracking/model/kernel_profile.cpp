#include "tracking/model/kernel_profile.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {
namespace {

constexpr double kPerWidth = 64;
constexpr double kMostValues = 1 << 16;
/// 1/(1 + e⁷): t of a tanh edge 3.5 w inside of it.
constexpr double kLeastTransmission = 9.110511944006454e-4;

}  // namespace

KernelProfile::KernelProfile(const DiscProfile& disc)
    : radius_(static_cast<float>(disc.radius())),
      two_over_width_(static_cast<float>(2 / disc.edge_width)),
      radius_over_(static_cast<float>(disc.diameter / disc.edge_width)),
      reach_(static_cast<float>(disc.reach())),
      reach2_(static_cast<float>(disc.reach() * disc.reach())) {
    if (disc.shape == &kTanhEdge) return;
    const double per_pixel = std::min(kPerWidth / disc.edge_width, kMostValues / disc.reach());
    per_pixel_ = static_cast<float>(per_pixel);
    const int count = static_cast<int>(std::ceil(disc.reach() * per_pixel)) + 2;
    for (int i = 0; i < count; ++i) {
        // The gradient has a limit at r = 0, which is never asked for exactly.
        const double r = std::max(i, 1) / per_pixel;
        const double t = 1 - disc.darkness(i / per_pixel);
        transmission_.push_back(static_cast<float>(std::max(t, kLeastTransmission)));
        gradient_.push_back(t > kLeastTransmission ? static_cast<float>(disc.slope(r) / (t * r))
                                                   : 0.0F);
    }
}

DiscTerms KernelProfile::terms() const {
    const float last = is_tabulated() ? static_cast<float>(transmission_.size() - 2) : 0.0F;
    return {radius_over_,
            two_over_width_,
            reach_,
            reach2_,
            is_tabulated() ? transmission_.data() : nullptr,
            gradient_.data(),
            per_pixel_,
            last};
}

float KernelProfile::darkness(float r) const {
    if (!is_tabulated()) return 1 / (1 + std::exp(two_over_width_ * (r - radius_)));
    const float place = std::min(r * per_pixel_, static_cast<float>(transmission_.size() - 2));
    const auto i = static_cast<std::size_t>(place);
    const float share = place - static_cast<float>(i);
    return 1 - (transmission_[i] + share * (transmission_[i + 1] - transmission_[i]));
}

}  // namespace grainfield::tracking
