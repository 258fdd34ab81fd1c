#pragma once

#include <cstddef>
#include <vector>

#include "tracking/model/disc_profile.h"

namespace grainfield::tracking {

/// What a kernel needs to know of a disc. Valid as long as the KernelProfile that it is from.
struct DiscTerms {
    float radius_over;     ///< (2/w) · D/2
    float two_over_width;  ///< 2/w [1/px]
    float reach;           ///< [px]
    float reach2;          ///< [px²]
    /// Tables at r = 0, 1/per_pixel, …; null: the tanh edge in closed form.
    const float* transmission;  ///< t
    const float* gradient;      ///< (dt/dr)/(t r) [1/px²]
    float per_pixel;            ///< values per pixel
    float last;                 ///< largest argument of a table, in values
};

/// The profile of a disc in single precision, as kernels take it.
///
/// The transmission t = 1 − P is held above 9.1e-4, so that a disc can be divided out again. A tanh
/// edge is computed in closed form. Any other shape is read from tables with 64 values per w and
/// linear interpolation: t to 2e-5 where P″ is as that of tanh. 0.2 ms for D/w = 13.
class KernelProfile {
 public:
    explicit KernelProfile(const DiscProfile& disc);

    DiscTerms terms() const;
    /// P(r).
    float darkness(float r) const;
    bool is_tabulated() const { return !transmission_.empty(); }

 private:
    float radius_, two_over_width_, radius_over_, reach_;
    float reach2_;
    float per_pixel_ = 0;
    std::vector<float> transmission_, gradient_;
};

}  // namespace grainfield::tracking
