#include "bench/tracking/layer_information.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/support/random.h"
#include "tests/support/slit_spheres.h"
#include "tracking/synthesis/random_moves.h"

namespace grainfield::bench {

using tracking::Point3;

namespace {

constexpr double kAround = 2;  // [a] spheres beyond the picture
constexpr double kShown = 1;   // [a] of them are free
constexpr double kMargin = 1.5;
constexpr float kUnlike = 0.3F;  // heights that are exchanged differ by it [a]
// Spheres cut off by the border leave no more open than this [a].
constexpr double kBorderKnown = 0.3;

/// How far a sphere lies within the picture [a].
double inside(const Point3& p) {
    constexpr auto kFar = static_cast<float>(kLayerFrame);
    return static_cast<double>(std::min({p.x, p.y, kFar - p.x, kFar - p.y}));
}

std::size_t class_of(double distance) {
    std::size_t which = 0;
    while (which < kClassEnds.size() && distance >= kClassEnds[which]) ++which;
    return which;
}

}  // namespace

std::vector<Point3> layer_of(std::uint64_t seed, double share) {
    const testing::SlitScene slit =
        testing::shaken_bilayer(kLayerFrame + 2 * kAround, kCellHeight, 0.9243, 0.15, 600, seed);
    RandomStream random(seed, "thinned");
    std::vector<Point3> spheres;
    for (std::size_t i = 0; i < slit.position.size(); ++i) {
        if (share < 1 && random.uniform() > share) continue;
        spheres.push_back({static_cast<float>(slit.position[i].x - kAround),
                           static_cast<float>(slit.position[i].y - kAround),
                           static_cast<float>(slit.z[i])});
    }
    if (share == 1) return spheres;
    return tracking::moved_at_random(std::move(spheres), kCellHeight - 1, 0.3, 200, seed, 0);
}

double distance_in_plane(const Point3& p, const Point3& q) {
    return std::hypot(static_cast<double>(p.x - q.x), static_cast<double>(p.y - q.y));
}

Point3 at_height(const Point3& p, float z, const tracking::MirrorOptics& optics) {
    if (!(optics.distance > 0)) return {p.x, p.y, z};
    const auto distance = static_cast<float>(optics.distance);
    const float share = (distance - z) / (distance - p.z);
    const auto mx = static_cast<float>(optics.middle_x);
    const auto my = static_cast<float>(optics.middle_y);
    return {mx + share * (p.x - mx), my + share * (p.y - my), z};
}

LayerInformation::LayerInformation(std::vector<Point3> spheres, const View& view, int threads)
    : spheres_(std::move(spheres)), optics_(view.optics), picture_(made(threads)) {}

tracking::PictureInformation LayerInformation::made(int threads) {
    optics_.middle_x = optics_.middle_y = 0.5 * kLayerFrame;
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        if (inside(spheres_[i]) > -kShown) free_.push_back(static_cast<std::int32_t>(i));
    }
    tracking::PictureSetting setting;
    setting.width = setting.height = static_cast<int>(kLayerFrame * setting.scale);
    setting.threads = threads;
    std::vector<tracking::SphereMotion> motions = tracking::motions_of(free_, kCellHeight);
    for (tracking::SphereMotion& motion : motions) {
        motion.known_to = std::min(motion.known_to, kBorderKnown);
    }
    return {spheres_, optics_, setting, std::move(motions)};
}

bool LayerInformation::is_judged(std::size_t i) const {
    return inside(of(i)) > kMargin;
}

std::size_t LayerInformation::nearest(std::size_t i) const {
    std::size_t best = i;
    for (std::size_t j = 0; j < free_.size(); ++j) {
        if (j == i) continue;
        if (best == i || distance_in_plane(of(i), of(j)) < distance_in_plane(of(i), of(best))) {
            best = j;
        }
    }
    return best;
}

void LayerInformation::add_bounds(std::vector<ClassBounds>& classes) const {
    const std::size_t n = picture_.size();
    std::vector<std::size_t> all(n);
    std::iota(all.begin(), all.end(), std::size_t{0});
    const std::vector<double> joint = picture_.covariance(all);
    for (std::size_t i = 0; i < free_.size(); ++i) {
        if (!is_judged(i)) continue;
        const std::size_t x = 3 * i;
        const std::vector<double> own = picture_.covariance({x, x + 1, x + 2});
        const auto variance = [&](std::size_t k) { return joint[k * n + k]; };
        const std::size_t j = nearest(i);
        const std::size_t which = class_of(distance_in_plane(of(i), of(j)));
        const auto add = [&](ClassBounds& bounds) {
            bounds.plane_known.push_back(std::sqrt(0.5 * (own[0] + own[4])));
            bounds.height_known.push_back(std::sqrt(own[8]));
            bounds.plane.push_back(std::sqrt(0.5 * (variance(x) + variance(x + 1))));
            bounds.height.push_back(std::sqrt(variance(x + 2)));
        };
        add(classes[which]);
        if (which <= 2) add(classes[of(i).z > of(j).z ? kClasses - 2 : kClasses - 1]);
    }
}

void LayerInformation::exchange(std::vector<std::vector<double>>& told) const {
    for (std::size_t i = 0; i < free_.size(); ++i) {
        for (std::size_t j = i + 1; j < free_.size(); ++j) {
            const double distance = distance_in_plane(of(i), of(j));
            if (distance >= kClassEnds.back() || !is_judged(i) || !is_judged(j) ||
                std::abs(of(i).z - of(j).z) < kUnlike) {
                continue;
            }
            std::vector<Point3> other = spheres_;
            other[index(i)] = at_height(of(i), of(j).z, optics_);
            other[index(j)] = at_height(of(j), of(i).z, optics_);
            told[class_of(distance)].push_back(
                picture_.told_from(other, {3 * i, 3 * i + 1, 3 * j, 3 * j + 1}));
        }
    }
}

LayerInformation::Told LayerInformation::told_from(const std::vector<Point3>& other) const {
    std::vector<std::size_t> plane;
    for (std::size_t i = 0; i < free_.size(); ++i) plane.insert(plane.end(), {3 * i, 3 * i + 1});
    return {picture_.rms_from(other), picture_.told_from(other, plane)};
}

LayerInformation::Told LayerInformation::turned() const {
    std::vector<Point3> other = spheres_;
    for (Point3& p : other) p = at_height(p, kTop - p.z, optics_);
    return told_from(other);
}

LayerInformation::Told LayerInformation::lifted(float height) const {
    std::vector<Point3> other = spheres_;
    for (Point3& p : other) p = at_height(p, p.z + height, optics_);
    return told_from(other);
}

}  // namespace grainfield::bench
