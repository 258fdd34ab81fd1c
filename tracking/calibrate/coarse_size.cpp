#include "tracking/calibrate/coarse_size.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tracking/detect/distance_transform.h"

namespace grainfield::tracking {
namespace {

constexpr double kSameSize = 0.15;

/// Centre of the window of ±15 % (in log radius) that holds the most discs, each counted as its
/// radius to the given power. 0 if there is none.
double most_frequent_radius(const std::vector<float>& radii, int power) {
    constexpr double kStep = 0.02;
    const double lowest = std::log(1.4);
    std::vector<double> area(400, 0.0);
    for (const float r : radii) {
        const double bin = (std::log(static_cast<double>(r)) - lowest) / kStep;
        if (bin >= 0 && bin < static_cast<double>(area.size())) {
            area[static_cast<std::size_t>(bin)] += std::pow(static_cast<double>(r), power);
        }
    }
    constexpr int kHalf = 4;
    double best = 0;
    int best_bin = -1;
    for (int i = 0; i < static_cast<int>(area.size()); ++i) {
        double sum = 0;
        for (int j = std::max(0, i - kHalf);
             j <= std::min(static_cast<int>(area.size()) - 1, i + kHalf); ++j) {
            sum += area[static_cast<std::size_t>(j)] * (1.0 - std::abs(i - j) / (kHalf + 1.0));
        }
        if (sum > best) {
            best = sum;
            best_bin = i;
        }
    }
    return best_bin < 0 ? 0.0 : std::exp(lowest + (best_bin + 0.5) * kStep);
}

struct Inscribed {
    int x, y;
    float radius;
};

std::vector<Inscribed> inscribed_discs(const Image& distance) {
    const int w = distance.width();
    const int h = distance.height();
    std::vector<Inscribed> discs;
    for (int y = 1; y < h - 1; ++y) {
        for (int x = 1; x < w - 1; ++x) {
            const float d = distance(x, y);
            if (d < 2) continue;
            bool highest = true;
            for (int dy = -1; dy <= 1 && highest; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const float other = distance(x + dx, y + dy);
                    // On plateaus the first pixel in reading order counts.
                    const bool before = dy < 0 || (dy == 0 && dx < 0);
                    if (other > d || (before && other == d)) {
                        highest = false;
                        break;
                    }
                }
            }
            // The nearest outside pixel centre lies half a pixel beyond the edge on average.
            if (highest) discs.push_back({x, y, std::sqrt(d) - 0.5F});
        }
    }
    return discs;
}

/// The area of the union of the discs of about that radius: in a wide gap the discs of many maxima
/// lie on one another.
CoarseSize size_at(double radius, const std::vector<Inscribed>& discs, const Image& mask,
                   double mask_area) {
    const int w = mask.width();
    const int h = mask.height();
    CoarseSize size;
    size.radius = radius;
    Image painted(w, h);
    double area = 0;
    for (const Inscribed& disc : discs) {
        if (std::abs(static_cast<double>(disc.radius) / radius - 1) > kSameSize) continue;
        ++size.discs;
        const float r = disc.radius + 0.5F;
        const int half = static_cast<int>(r);
        for (int y = std::max(0, disc.y - half); y <= std::min(h - 1, disc.y + half); ++y) {
            const auto dy = static_cast<float>(y - disc.y);
            const int chord = static_cast<int>(std::sqrt(std::max(0.0F, r * r - dy * dy)));
            for (int x = std::max(0, disc.x - chord); x <= std::min(w - 1, disc.x + chord); ++x) {
                if (painted(x, y) > 0 || mask(x, y) <= 0.5F) continue;
                painted(x, y) = 1;
                ++area;
            }
        }
    }
    size.coverage = area / mask_area;
    return size;
}

}  // namespace

std::vector<CoarseSize> coarse_sizes(const Image& mask) {
    const std::vector<Inscribed> discs = inscribed_discs(squared_distance_transform(mask));
    std::vector<float> radii;
    for (const Inscribed& disc : discs) radii.push_back(disc.radius);
    double mask_area = 0;
    for (const float v : mask.pixels()) mask_area += v > 0.5F ? 1 : 0;
    std::vector<CoarseSize> sizes;
    for (const int power : {2, 1, 0}) {
        const double radius = most_frequent_radius(radii, power);
        const bool is_known = std::any_of(sizes.begin(), sizes.end(), [&](const CoarseSize& s) {
            return std::abs(s.radius / radius - 1) < kSameSize;
        });
        if (radius > 0 && !is_known) sizes.push_back(size_at(radius, discs, mask, mask_area));
    }
    return sizes;
}

}  // namespace grainfield::tracking
