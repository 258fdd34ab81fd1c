#include "bench/tracking/rimmed_discs.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace grainfield::bench {
namespace {

constexpr int kFine = 3;         // points a pixel, along each axis
constexpr double kBright = 0.8;  // of full scale
constexpr double kStray = 0.03;  // of the bright field

/// All lengths in a.
struct RimmedDisc {
    double radius, core;
    double rim;
    bool brighter_outwards;

    double brightness(double r) const {
        if (r <= core) return 0;
        return brighter_outwards ? rim * (r - core) / (radius - core) : rim;
    }
};

}  // namespace

Image rimmed_discs(std::span<const Vec3> spheres, double scale, int width, int height,
                   RandomStream& random) {
    RimmedDisc disc{};
    disc.radius = 0.5 * random.uniform(0.84, 1.02);
    disc.core = disc.radius * random.uniform(0.6, 0.95);
    const double rim = random.uniform();
    disc.rim = 0.9 * rim * rim;
    disc.brighter_outwards = random.uniform() < 0.4;
    const double blur = random.uniform(0.02, 0.13) * scale;
    const double noise = 0.005 * std::pow(10, random.uniform());
    std::vector<Vec3> upwards(spheres.begin(), spheres.end());
    std::stable_sort(upwards.begin(), upwards.end(), [](Vec3 a, Vec3 b) { return a.z < b.z; });
    cv::Mat1f fine(height * kFine, width * kFine, 1.0F);
    const auto at = [](double v) { return (v + 0.5) * kFine - 0.5; };
    for (const Vec3& sphere : upwards) {
        const double reach = disc.radius * scale * kFine;
        const double x = at(sphere.x);
        const double y = at(sphere.y);
        const int y1 = std::min(fine.rows - 1, static_cast<int>(std::floor(y + reach)));
        const int x1 = std::min(fine.cols - 1, static_cast<int>(std::floor(x + reach)));
        for (int row = std::max(0, static_cast<int>(std::ceil(y - reach))); row <= y1; ++row) {
            for (int column = std::max(0, static_cast<int>(std::ceil(x - reach))); column <= x1;
                 ++column) {
                const double r = std::hypot(column - x, row - y) / (scale * kFine);
                if (r <= disc.radius) fine(row, column) = static_cast<float>(disc.brightness(r));
            }
        }
    }
    cv::Mat1f seen;
    cv::resize(fine, seen, {width, height}, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(seen, seen, {0, 0}, blur);
    Image counts(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double light = kStray + (1 - kStray) * static_cast<double>(seen(y, x));
            const double value = 255 * kBright * (light + noise * random.normal());
            counts(x, y) = static_cast<float>(std::clamp(std::round(value), 0.0, 255.0));
        }
    }
    return counts;
}

}  // namespace grainfield::bench
