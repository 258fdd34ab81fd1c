#include "tracking/synthesis/error_scale.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "core/image_part.h"
#include "core/support/random.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/synthesis/mirror_scene.h"
#include "tracking/synthesis/random_moves.h"

namespace grainfield::tracking {
namespace {

constexpr double kPart = 14;        // [a]
constexpr double kAround = 3;       // [a] spheres beyond the part that are mirrored in it
constexpr double kMargin = 2;       // [a] from the border of the part: what lies beyond is not seen
constexpr double kSame = 0.3;       // [a]
constexpr double kMoveStep = 0.06;  // [a]
constexpr int kMoveSweeps = 60;
constexpr int kMostDraws = 3;
constexpr std::size_t kEnough = 160;  // spheres
// Of a Gaussian lies within σ and 2σ.
constexpr std::array<double, 2> kWithin = {0.6827, 0.9545};
constexpr double kManyRays = 40;
constexpr std::uint64_t kSeed = 1;

Vec2 in_plane(const Point3& p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

std::vector<Vec2> in_plane(const std::vector<Point3>& spheres) {
    std::vector<Vec2> places;
    for (const Point3& p : spheres) places.push_back(in_plane(p));
    return places;
}

/// The nearest of the points within `range`, or −1.
std::ptrdiff_t nearest(const PointGrid& grid, double range, Vec2 place) {
    std::ptrdiff_t best = -1;
    double least = range * range;
    grid.near(place, range, [&](std::uint32_t j, Vec2 q) {
        if (squared_norm(q - place) >= least) return;
        least = squared_norm(q - place);
        best = static_cast<std::ptrdiff_t>(j);
    });
    return best;
}

struct Ratios {
    std::array<std::vector<double>, 2> plane, height;  ///< |error| / stated error, by class
    std::size_t spheres() const { return height[0].size() + height[1].size(); }
};

/// The rectangle of the image that is rendered again.
struct Part {
    int x0, y0;       ///< its first pixel
    double diameter;  ///< [px]
    const Image& whole;
    Image ceiling;  ///< of the part
};

/// These spheres as the frame would show them, with what the rendering of the frame left over.
Image image_of(const std::vector<Point3>& spheres, const MirrorOptics& optics,
               const BrightnessSynthesis& found, const Part& part, int threads) {
    const int columns = part.ceiling.width();
    const int rows = part.ceiling.height();
    MirrorImage image(columns, rows, part.diameter, threads, kManyRays);
    image.render_only(MirrorScene(spheres, optics));
    Image seen(columns, rows);
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const double light = found.light(static_cast<double>(image.image()(x, y)),
                                             from_middle(part.whole, part.x0 + x, part.y0 + y));
            // Mirrored: where it was found, spheres have followed it already.
            const float left = found.residual(part.x0 + columns - 1 - x, part.y0 + y);
            seen(x, y) = std::min(
                found.uneven.uneven(static_cast<float>(light) + left, part.x0 + x, part.y0 + y),
                part.ceiling(x, y));
        }
    }
    return seen;
}

/// Adds the ratios of the spheres that lie well within the part.
void judge(const BrightnessSynthesis& fit, const std::vector<Point3>& truth, Vec2 farthest,
           Ratios& ratios) {
    const auto inside = [&](Vec2 p) {
        return std::min({p.x, p.y, farthest.x - p.x, farthest.y - p.y});
    };
    const std::vector<std::size_t> classes = overlap_classes(fit.spheres);
    const std::vector<Vec2> true_places = in_plane(truth);
    const PointGrid true_grid(true_places, kSame);
    struct Error {
        std::size_t sphere, overlap;
        double z;
    };
    std::vector<Error> errors;
    double mean = 0;
    for (std::size_t i = 0; i < fit.spheres.size(); ++i) {
        const Vec2 p = in_plane(fit.spheres[i]);
        if (fit.is_doubtful[i] != 0 || inside(p) < kMargin) continue;
        const std::ptrdiff_t j = nearest(true_grid, kSame, p);
        if (j < 0) continue;
        const auto t = static_cast<std::size_t>(j);
        const Vec2 off = p - true_places[t];
        ratios.plane[classes[i]].push_back(std::abs(off.x) / fit.error[i].x);
        ratios.plane[classes[i]].push_back(std::abs(off.y) / fit.error[i].y);
        errors.push_back({i, classes[i], static_cast<double>(fit.spheres[i].z - truth[t].z)});
        mean += errors.back().z;
    }
    if (!errors.empty()) mean /= static_cast<double>(errors.size());
    for (const Error& e : errors) {
        ratios.height[e.overlap].push_back(std::abs(e.z - mean) / fit.error[e.sphere].z);
    }
}

}  // namespace

std::array<double, 2> error_factors(const std::array<std::vector<double>, 2>& ratios,
                                    std::size_t per_sphere) {
    std::array<double, 2> factor = {1, 1};
    const bool are_together =
        std::min(ratios[0].size(), ratios[1].size()) < ErrorScale::kLeast * per_sphere;
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<double> sorted = ratios[k];
        if (are_together) sorted.insert(sorted.end(), ratios[1 - k].begin(), ratios[1 - k].end());
        for (std::size_t sigmas = 1; sigmas <= 2; ++sigmas) {
            const auto at =
                static_cast<std::size_t>(kWithin[sigmas - 1] * static_cast<double>(sorted.size()));
            const auto quantile = sorted.begin() + static_cast<std::ptrdiff_t>(at);
            std::nth_element(sorted.begin(), quantile, sorted.end());
            factor[k] = std::max(factor[k], *quantile / static_cast<double>(sigmas));
        }
    }
    return factor;
}

std::vector<std::size_t> overlap_classes(const std::vector<Point3>& spheres) {
    const std::vector<Vec2> places = in_plane(spheres);
    const PointGrid grid(places, ErrorScale::kOverlapping);
    std::vector<std::size_t> classes(spheres.size(), 1);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        grid.near(places[i], ErrorScale::kOverlapping, [&](std::uint32_t j, Vec2) {
            if (j != i) classes[i] = 0;
        });
    }
    return classes;
}

ErrorScale learn_error_scale(const Image& brightness, const Image& ceiling, double diameter,
                             const BrightnessStart& start, const BrightnessSynthesis& found,
                             double height, int searches, int threads) {
    const int side = static_cast<int>(kPart * diameter);
    const int columns = std::min(side, brightness.width());
    const int rows = std::min(side, brightness.height());
    const int x0 = (brightness.width() - columns) / 2;
    const int y0 = (brightness.height() - rows) / 2;
    const auto shift_x = static_cast<float>(x0 / diameter);
    const auto shift_y = static_cast<float>(y0 / diameter);
    const double wide = (columns - 1) / diameter;
    const double high = (rows - 1) / diameter;
    const auto inside = [&](Vec2 p) { return std::min({p.x, p.y, wide - p.x, high - p.y}); };
    MirrorOptics optics = found.optics;
    optics.middle_x -= static_cast<double>(shift_x);
    optics.middle_y -= static_cast<double>(shift_y);
    std::vector<Point3> spheres;
    for (const Point3& p : found.spheres) {
        const Point3 here{p.x - shift_x, p.y - shift_y, p.z};
        if (inside(in_plane(here)) >= -kAround) spheres.push_back(here);
    }
    std::vector<Vec2> ways;  // from sphere to disc
    const std::vector<Vec2> fitted = in_plane(found.spheres);
    const PointGrid grid(fitted, kSame);
    for (const Point3& p : start.spheres) {
        const std::ptrdiff_t i = nearest(grid, kSame, in_plane(p));
        if (i >= 0) ways.push_back(in_plane(p) - fitted[static_cast<std::size_t>(i)]);
    }
    const Part part{x0, y0, diameter, brightness, part_of(ceiling, x0, y0, columns, rows)};
    Ratios ratios;
    for (std::uint64_t draw = 0; draw < kMostDraws && ratios.spheres() < kEnough; ++draw) {
        const std::vector<Point3> truth =
            moved_at_random(spheres, height - 1, kMoveStep, kMoveSweeps, kSeed, draw);
        const Image seen = image_of(truth, optics, found, part, threads);
        RandomStream random(kSeed, "error scale", draw);
        BrightnessStart again{.spheres = {},
                              .are_heights_known = false,
                              .optics = start.optics,
                              .are_optics_known = start.are_optics_known};
        again.optics.middle_x = optics.middle_x;
        again.optics.middle_y = optics.middle_y;
        for (const Point3& p : truth) {
            Vec2 way{0, 0};
            if (!ways.empty()) {
                const double at = random.uniform(0, static_cast<double>(ways.size()));
                way = ways[std::min(ways.size() - 1, static_cast<std::size_t>(at))];
            }
            again.spheres.push_back({p.x + static_cast<float>(way.x),
                                     p.y + static_cast<float>(way.y),
                                     static_cast<float>(0.5 * (height - 1))});
        }
        const BrightnessSynthesis fit =
            synthesise_brightness(seen, part.ceiling, diameter, again, height, searches, threads);
        judge(fit, truth, {wide, high}, ratios);
    }
    if (ratios.spheres() < ErrorScale::kLeast) return {};
    ErrorScale scale{.plane = error_factors(ratios.plane, 2),
                     .height = error_factors(ratios.height, 1),
                     .spheres = static_cast<std::int64_t>(ratios.spheres())};
    for (double& factor : scale.height) factor = std::max(factor, found.overlap_factor);
    return scale;
}

void transfer(NumberArchive& archive, ErrorScale& scale) {
    auto& [plane, height, spheres] = scale;
    archive.members<ErrorScale>(plane[0], plane[1], height[0], height[1], spheres);
}

}  // namespace grainfield::tracking
