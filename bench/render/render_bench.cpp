// Milliseconds a frame of each stage at the experiment's size: 1600² pixels, 11,704 grains.
// `silhouette`: these alone. `raytrace [threads]`: frames of five instants, ray-traced. `sampling`:
// error against rays.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include "core/support/random.h"
#include "simulate/render/optics/raytrace.h"
#include "simulate/render/optics/silhouette.h"
#include "simulate/render/sensor/camera.h"

namespace {

using namespace grainfield;
using namespace grainfield::simulate;

double processor_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Median and least, by the clock and of the processor: on a shared machine the second means more.
template <class Work>
void report(const char* name, int repeats, Work&& work) {
    std::vector<double> times, processor;
    for (int i = 0; i < repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const double begin = processor_ms();
        work();
        processor.push_back(processor_ms() - begin);
        times.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count());
    }
    std::sort(times.begin(), times.end());
    std::sort(processor.begin(), processor.end());
    std::printf("%-28s %9.1f ms (least %.1f), processor %.1f ms (%.1f – %.1f)\n", name,
                times[times.size() / 2], times.front(), processor[processor.size() / 2],
                processor.front(), processor.back());
}

SphereScene layer(bool crystal) {
    SphereScene scene;
    scene.high_plate = 1.94;
    RandomStream random(1, "render bench");
    const double spacing = crystal ? 0.81 : 0.9243;
    for (int i = 0; scene.centre.size() < 11704; ++i) {
        const int column = i % 108;
        const int row = i / 108;
        scene.centre.push_back({(column + 0.5) * spacing + random.uniform(-0.1, 0.1),
                                (row + 0.5) * spacing + random.uniform(-0.1, 0.1),
                                (column + row) % 2 == 0 ? 0.5 : 1.44});
    }
    return scene;
}

/// The layer at `count` instants, every sphere on its way of RMS 0.03 a per axis between first and
/// last.
std::vector<SphereScene> exposed(const SphereScene& scene, int count) {
    std::vector<SphereScene> instants(static_cast<std::size_t>(count), scene);
    RandomStream random(2, "render bench motion");
    for (std::size_t i = 0; i < scene.centre.size(); ++i) {
        const Vec3 way{0.03 * random.normal(), 0.03 * random.normal(), 0};
        for (std::size_t k = 0; k < instants.size(); ++k) {
            const double part = count > 1 ? static_cast<double>(k) / (count - 1) - 0.5 : 0;
            instants[k].centre[i] += way * part;
        }
    }
    return instants;
}

/// Full frames, as `scene-raytrace.toml` asks for them.
void trace(int threads) {
    const RenderOptions options;
    const View view(options.view, {{0, 0}, {100, 100}, {}, 1.94}, 1.94);
    const Camera camera(options, view, 1, threads);
    const View fine = camera.radiance_view(view);
    for (const bool crystal : {false, true}) {
        const auto instants = exposed(layer(crystal), 5);
        RaytraceOptics optics(options.optics.of<Raytrace>(), threads);
        report(crystal ? "raytrace, s = .81 a" : "raytrace, s = .924 a", 3,
               [&] { optics.radiance(instants, fine); });
        const double pixels = 3 * 1600.0 * 1600;
        std::printf("  %d threads; %.2f rays a pixel of the frame, %.2f samples\n", threads,
                    optics.cost().rays / pixels, optics.cost().samples / pixels);
    }
}

double rms(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto d = static_cast<double>(a.pixels()[i] - b.pixels()[i]);
        sum += d * d;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Sampling error after the blur against rays, in the middle of the layer.
void sampling() {
    struct Way {
        double tolerance;
        int samples;
    };
    for (const bool crystal : {false, true}) {
        RenderOptions options;
        options.view.width = options.view.height = 96;
        options.view.scale = 16;
        const double middle = crystal ? 43.7 : 49.9;
        const View view(options.view, {{middle - 3, middle - 3}, {6, 6}, {}, 1.94}, 1.94);
        const Camera camera(options, view, 1, 2);
        const View fine = camera.radiance_view(view);
        const auto instants = exposed(layer(crystal), 5);
        RaytraceOptions reference;
        reference.tolerance = 0;
        reference.most_samples = 300;
        RaytraceOptics exact(reference, 2);
        const Image truth = camera.exposure(exact.radiance(instants, fine));
        const double unit = camera.mean_counts(1) - camera.mean_counts(0);
        double noise = 0;
        for (const float v : truth.pixels())
            noise += camera.variance_counts(static_cast<double>(v));
        noise = std::sqrt(noise / static_cast<double>(truth.size())) / unit;
        std::printf("s = %s, camera noise %.3f %%\n", crystal ? ".81 a" : ".924 a", 100 * noise);
        for (const Way way :
             {Way{0, 2}, Way{0, 4}, Way{0, 8}, Way{0.4, 16}, Way{0.3, 16}, Way{0.25, 16},
              Way{0.2, 16}, Way{0.185, 16}, Way{0.185, 8}, Way{0.15, 16}, Way{0.1, 16}}) {
            RaytraceOptions o;
            o.tolerance = way.tolerance;
            o.most_samples = way.samples;
            RaytraceOptics optics(o, 2);
            const double begin = processor_ms();
            const Image radiance = optics.radiance(instants, fine);
            const double spent = processor_ms() - begin;
            std::printf("  tolerance %.3f, %d samples: error %.3f %%, %.2f µs, %.1f rays a pixel\n",
                        way.tolerance, way.samples, 100 * rms(camera.exposure(radiance), truth),
                        1e3 * spent / (96.0 * 96), optics.cost().rays / (96.0 * 96));
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const char* what = argc > 1 ? argv[1] : "";
    if (std::strcmp(what, "raytrace") == 0) {
        trace(argc > 2 ? std::atoi(argv[2]) : 2);
        return 0;
    }
    if (std::strcmp(what, "sampling") == 0) {
        sampling();
        return 0;
    }
    const bool all_stages = std::strcmp(what, "silhouette") != 0;
    const RenderOptions options;
    const View view(options.view, {{0, 0}, {100, 100}, {}, 1.94}, 1.94);
    const Camera camera(options, view, 1, 1);
    const View fine = camera.radiance_view(view);
    for (const bool crystal : {false, true}) {
        const SphereScene scene = layer(crystal);
        SilhouetteOptics optics({}, 1);
        report(crystal ? "silhouette, s = .81 a" : "silhouette, s = .924 a", 15,
               [&] { optics.radiance(scene, view); });
        if (!all_stages) continue;
        report("  on the camera's fine grid", 7, [&] { optics.radiance(scene, fine); });
        const Image radiance = optics.radiance(scene, fine);
        report("  blur and light", 7, [&] { static_cast<void>(camera.exposure(radiance)); });
        const Image exposure = camera.exposure(radiance);
        report("  sensor", 7, [&] { static_cast<void>(camera.develop(exposure, 1)); });
    }
    return 0;
}
