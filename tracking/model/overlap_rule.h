#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/band_sums.h"
#include "tracking/model/kernel_profile.h"

namespace grainfield::tracking {

/// A pixel seen from the centre of a disc [px].
struct DiscPixel {
    float r, dx, dy;
};

/// The discs that reach rows [first, last) of an image, in order of their index.
struct DiscBand {
    int first, last;
    const std::vector<Vec2>& positions;
    const BandSums& sums;  ///< of all of them, T = Π_j t_j among them
    const DiscProfile& disc;
    const KernelProfile& profile;

    /// Calls action(x, row − first, pixel) for the pixels of the band that each disc reaches and
    /// that are at least `inner` from its centre, disc by disc.
    template <class Action>
    void each_pixel(float inner, Action&& action) const;
};

/// How discs that overlap make one image: what the product of transmissions lacks.
///
/// The fit multiplies transmissions, T = Π_j t_j, because one disc can then be moved alone. Any
/// other rule states the transmission T' of the whole scene at given positions; the product is
/// fitted to the darkness image plus T' − T, again and again (model/product_image.h). At rest the
/// residual of the rule's image is orthogonal to the derivatives of the product, so that positions
/// have no bias; their error is the smallest possible where both derivatives agree. Objects of this
/// class are constants that live as long as the program. Thread-safe.
class OverlapRule {
 public:
    OverlapRule(const OverlapRule&) = delete;
    OverlapRule& operator=(const OverlapRule&) = delete;
    virtual ~OverlapRule() = default;

    /// As it is called in options: "blurred-union".
    virtual std::string_view name() const = 0;
    /// As a noun: "blurred union of discs".
    virtual std::string_view title() const = 0;
    /// As a condition: "if the union of discs is blurred".
    virtual std::string_view condition() const = 0;
    /// The name in words: "blurred union".
    std::string words() const;

    /// Nothing is to be added.
    virtual bool is_product() const { return false; }
    /// Adds T' − T to the rows of the band.
    virtual void add_to(const DiscBand& discs, Image& darkness) const = 0;

 protected:
    constexpr OverlapRule() = default;
};

/// Each disc dims what the others let pass: T' = T. Right for spheres far from focus, and exact
/// where edges do not meet.
class ProductRule final : public OverlapRule {
 public:
    constexpr ProductRule() = default;
    std::string_view name() const override { return "product"; }
    std::string_view title() const override { return "product of transmissions"; }
    std::string_view condition() const override { return "if transmissions multiply"; }
    bool is_product() const override { return true; }
    void add_to(const DiscBand&, Image&) const override {}
};

inline constinit const ProductRule kProductRule;

inline std::string OverlapRule::words() const {
    std::string words(name());
    std::replace(words.begin(), words.end(), '-', ' ');
    return words;
}

template <class Action>
void DiscBand::each_pixel(float inner, Action&& action) const {
    const auto outer = static_cast<float>(disc.reach());
    const int width = sums.width();
    for (const Vec2 p : positions) {
        const auto cx = static_cast<float>(p.x);
        const auto cy = static_cast<float>(p.y);
        const int y0 = std::max(first, static_cast<int>(std::ceil(cy - outer)));
        const int y1 = std::min(last - 1, static_cast<int>(std::floor(cy + outer)));
        const int x0 = std::max(0, static_cast<int>(std::ceil(cx - outer)));
        const int x1 = std::min(width - 1, static_cast<int>(std::floor(cx + outer)));
        for (int y = y0; y <= y1; ++y) {
            const float dy = static_cast<float>(y) - cy;
            for (int x = x0; x <= x1; ++x) {
                const float dx = static_cast<float>(x) - cx;
                const float r2 = dx * dx + dy * dy;
                if (r2 > outer * outer || r2 < inner * inner) continue;
                action(x, y - first, DiscPixel{std::sqrt(r2), dx, dy});
            }
        }
    }
}

}  // namespace grainfield::tracking
