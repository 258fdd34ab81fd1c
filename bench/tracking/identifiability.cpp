// What one picture of mirror-like spheres tells of x, y and z: bounds of errors of lone spheres, of
// pairs and of layers, and by how much pictures with heights exchanged differ.
//
//   bench.tracking.identifiability [pair] [thinned] [layer]
//
// Prints rows plot,series,x,y: lengths in a, noise 1 % of the radiance of the panel, 16 px/a. Rows
// of classes have their number as x. scripts/identifiability-plots draws them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/tracking/layer_information.h"
#include "tracking/synthesis/picture_information.h"

namespace {

using namespace grainfield;
using namespace grainfield::bench;
using namespace grainfield::tracking;

constexpr int kThreads = 2;
constexpr double kOffAxis = 10;  // of the camera: lone spheres and pairs [a]
constexpr float kLift = 0.1F;    // [a]

/// The middle of what `validate --optics random` draws, cameras at a distance, and both ends of
/// reflectivity and panel: the farther the panel, the steeper the rays that still meet it.
std::vector<View> views() {
    const MirrorOptics middle{.reflectivity = 0.7, .blur = 0.08, .ambient = 0.04, .grazing = 0.2};
    std::vector<View> all = {{"telecentric", middle},
                             {"camera at 200 a", middle},
                             {"camera at 60 a", middle},
                             {"near panel", middle},
                             {"far panel", middle}};
    all[1].optics.distance = 200;
    all[2].optics.distance = 60;
    all[3].optics.reflectivity = 0.5;
    all[3].optics.grazing = 0.05;
    all[4].optics.reflectivity = 0.9;
    all[4].optics.grazing = 0.4;
    return all;
}

void row(const std::string& plot, const std::string& series, double x, double y) {
    fmt::print("{},{},{:.6g},{:.6g}\n", plot, series, x, y);
    std::fflush(stdout);
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

/// Spheres that rise by these shares of a height, each along the line on which the camera sees it.
SphereMotion rise(const std::vector<Point3>& spheres, const std::vector<float>& share, double step,
                  const MirrorOptics& optics) {
    SphereMotion motion;
    motion.step = step;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        const Point3& p = spheres[i];
        const Point3 above = at_height(p, p.z + share[i], optics);
        motion.sphere.push_back(static_cast<std::int32_t>(i));
        motion.along.push_back({above.x - p.x, above.y - p.y, share[i]});
    }
    return motion;
}

/// x, y of all, their height together, and the difference of the heights of two. Only perspective
/// tells the height of all: a long step, or too few rays change.
std::vector<SphereMotion> motions_together(const std::vector<Point3>& spheres,
                                           const MirrorOptics& optics) {
    constexpr double kLongStep = 0.4;
    const bool is_pair = spheres.size() == 2;
    std::vector<SphereMotion> motions = motions_of({0, 1}, kCellHeight);
    motions.erase(motions.begin() + 5);
    motions.erase(motions.begin() + 2);
    if (!is_pair) motions.resize(2);
    motions.push_back(rise(spheres, std::vector<float>(spheres.size(), 1), kLongStep, optics));
    motions.back().known_to = anywhere_between(kCellHeight);
    if (is_pair) {
        motions.push_back(rise(spheres, {0.5F, -0.5F}, kHeightStep, optics));
        motions.back().known_to = std::numbers::sqrt2 * anywhere_between(kCellHeight);
    }
    return motions;
}

/// Bounds of coordinates that are all free [a].
std::vector<double> bounds(const PictureInformation& picture) {
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < picture.size(); ++k) all.push_back(k);
    const std::vector<double> covariance = picture.covariance(all);
    std::vector<double> result;
    for (const std::size_t k : all) result.push_back(std::sqrt(covariance[k * all.size() + k]));
    return result;
}

void measure_lone(const View& view, const PictureSetting& setting, float middle) {
    const std::vector<Point3> sphere = {{middle, middle, 0.5F * kTop}};
    const PictureInformation picture(sphere, view.optics, setting,
                                     motions_together(sphere, view.optics));
    row("lone", view.name + ": x", 0, bounds(picture)[0]);
    row("lone", view.name + ": z", 0, bounds(picture)[2]);
}

/// Of a pair in the middle of the cell: bounds of heights and of the places where the camera sees
/// them, and the exchange of heights, x and y following.
void measure_pair(const View& view, const PictureSetting& setting, float middle, double distance) {
    constexpr double kAngle = 0.4;  // to the rows of pixels
    // A gap of 0.03 a at least, and heights that differ by half a diameter at least.
    const auto dz = static_cast<float>(
        std::max(0.5, std::sqrt(std::max(0.0, 1.03 * 1.03 - distance * distance))));
    const float low = 0.5F * (kTop - dz);
    const auto u = static_cast<float>(0.5 * distance * std::cos(kAngle));
    const auto v = static_cast<float>(0.5 * distance * std::sin(kAngle));
    const std::vector<Point3> pair = {{middle + u, middle + v, low + dz},
                                      {middle - u, middle - v, low}};
    const std::vector<Point3> exchanged = {at_height(pair[0], low, view.optics),
                                           at_height(pair[1], low + dz, view.optics)};
    const PictureInformation picture(pair, view.optics, setting,
                                     motions_together(pair, view.optics));
    const std::vector<double> bound = bounds(picture);
    row("pair", view.name + ": x", distance, std::hypot(bound[0], bound[2]) / std::numbers::sqrt2);
    row("pair", view.name + ": z together", distance, bound[4]);
    row("pair", view.name + ": z difference", distance, bound[5]);
    row("pair flip", view.name, distance, picture.told_from(exchanged, {0, 1, 2, 3}));
}

/// More pixels with more noise tell the same, and few rays change where only perspective does.
PictureSetting finer(int times) {
    return {.width = 144 * times,
            .height = 144 * times,
            .scale = 16.0 * times,
            .noise = 0.01 * times,
            .rays = 64.0 * times,
            .threads = kThreads};
}

void measure_pairs() {
    constexpr float kMiddle = 4.5;  // of the picture [a]
    for (View view : views()) {
        view.optics.middle_x = static_cast<double>(kMiddle) - kOffAxis;
        view.optics.middle_y = static_cast<double>(kMiddle);
        measure_lone(view, finer(4), kMiddle);
        for (int k = 0; k <= 19; ++k) measure_pair(view, finer(2), kMiddle, 0.46 + 0.06 * k);
        for (const double distance : {2.0, 2.5, 3.0, 4.0, 5.0}) {
            measure_pair(view, finer(2), kMiddle, distance);
        }
    }
}

void print_told(const LayerInformation& layer, const std::string& name, double seed) {
    const LayerInformation::Told turned = layer.turned();
    row("turned", name + ": rms", seed, turned.rms);
    row("turned", name + ": noises", seed, turned.noises);
    const LayerInformation::Told lifted = layer.lifted(kLift);
    row("lifted", name + ": rms", seed, lifted.rms);
    row("lifted", name + ": noises", seed, lifted.noises);
}

/// Layers of two seeds: bounds by class, and what is told of pairs and of all.
void measure_layers(const std::string& plot, double share) {
    for (const View& view : views()) {
        std::vector<ClassBounds> classes(kClasses);
        std::vector<std::vector<double>> told(kClassEnds.size());
        for (const std::uint64_t seed : {1U, 2U}) {
            const LayerInformation layer(layer_of(seed, share), view, kThreads);
            layer.add_bounds(classes);
            layer.exchange(told);
            if (share == 1) print_told(layer, view.name, static_cast<double>(seed));
        }
        for (std::size_t c = 0; c < classes.size(); ++c) {
            const ClassBounds& b = classes[c];
            const auto x = static_cast<double>(c);
            if (b.height.empty()) continue;
            row(plot, view.name + ": spheres", x, static_cast<double>(b.height.size()));
            row(plot, view.name + ": x known", x, median(b.plane_known));
            row(plot, view.name + ": z known", x, median(b.height_known));
            row(plot, view.name + ": x", x, median(b.plane));
            row(plot, view.name + ": z", x, median(b.height));
            row(plot, view.name + ": z worst", x, *std::ranges::max_element(b.height));
        }
        for (std::size_t c = 0; c < told.size(); ++c) {
            if (told[c].empty()) continue;
            const auto x = static_cast<double>(c);
            row(plot + " exchange", view.name + ": pairs", x, static_cast<double>(told[c].size()));
            row(plot + " exchange", view.name + ": median", x, median(told[c]));
            row(plot + " exchange", view.name + ": least", x, *std::ranges::min_element(told[c]));
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::pair<std::string, std::function<void()>>> plots = {
        {"pair", measure_pairs},
        {"thinned", [] { measure_layers("thinned", 0.4); }},
        {"layer", [] { measure_layers("layer", 1); }}};
    fmt::print("plot,series,x,y\n");
    for (const auto& plot : plots) {
        const auto is_asked = [&](const char* name) { return plot.first == name; };
        if (argc == 1 || std::any_of(argv + 1, argv + argc, is_asked)) plot.second();
    }
    return 0;
}
