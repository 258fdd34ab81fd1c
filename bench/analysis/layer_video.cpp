// A file as a tracker makes it from 3,000 frames of a layer, for timing `analyze` as a whole: a
// square crystal in the middle whose grains vibrate about their sites, grains that diffuse around
// it, and sightings that are missing here and there. Nothing physical beyond that.
//   bench.analysis.layer_video OUTPUT.h5 [frames = 3000] [particles = 11704]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/support/random.h"
#include "io/h5/trajectory_file.h"

using namespace grainfield;

namespace {

constexpr double diameter = 16;  // px

// Back into [0, length] as by a mirror.
double reflected(double x, double length) {
    x = std::abs(std::fmod(x, 2 * length));
    return x > length ? 2 * length - x : x;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fputs("usage: bench.analysis.layer_video OUTPUT.h5 [frames] [particles]\n", stderr);
        return 2;
    }
    const int frames = argc > 2 ? std::atoi(argv[2]) : 3000;
    const auto particles = static_cast<std::size_t>(argc > 3 ? std::atoi(argv[3]) : 11704);
    // As dense as 11,704 grains in 100 a.
    const double side = diameter * std::sqrt(static_cast<double>(particles) / 1.1704);
    const double spacing = 0.81 * diameter;
    const auto row = static_cast<std::size_t>(0.55 * side / spacing);
    std::vector<Vec2> home;
    for (std::size_t i = 0; i < row * row && i < particles; ++i) {
        home.push_back(
            {0.5 * side + (static_cast<double>(i % row) - 0.5 * static_cast<double>(row)) * spacing,
             0.5 * side +
                 (static_cast<double>(i / row) - 0.5 * static_cast<double>(row)) * spacing});
    }
    const std::size_t solid = home.size();
    RandomStream start(1, "layer video");
    while (home.size() < particles) {
        home.push_back({side * start.uniform(), side * start.uniform()});
    }
    TrajectoryInfo info;
    info.origin = Origin::video;
    info.length_unit = LengthUnit::pixel;
    info.time_unit = TimeUnit::second;
    info.diameter = diameter;
    info.frame_rate = 500;
    info.vibration_frequency = 80;
    info.source = "layer_video";
    io::TrajectoryWriter writer(argv[1], info, Overwrite::force);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(2, "layer video", static_cast<std::uint64_t>(f));
        Snapshot s;
        s.frame = f;
        s.time = f / 500.0;
        s.box = {{-0.5, -0.5}, {side, side}, {Boundary::walls, Boundary::walls}, 0};
        for (std::size_t i = 0; i < particles; ++i) {
            const Vec2 kick{random.normal(), random.normal()};
            if (i >= solid) {
                home[i] += 0.05 * diameter * kick;
                home[i] = {reflected(home[i].x, side), reflected(home[i].y, side)};
            }
            if (random.uniform() < 0.002) continue;
            const Vec2 shown = i < solid ? home[i] + 0.03 * diameter * kick : home[i];
            s.position.push_back(shown - Vec2{0.5, 0.5});
            s.id.push_back(static_cast<std::int64_t>(i));
        }
        writer.write(s);
    }
    writer.finish({});
    return 0;
}
