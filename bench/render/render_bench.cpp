// Milliseconds a frame of each stage at the experiment's size: 1600² pixels, 11,704 grains.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <vector>

#include "core/random.h"
#include "simulate/render/camera.h"
#include "simulate/render/raytrace.h"
#include "simulate/render/silhouette.h"

namespace {

using namespace grainfield;
using namespace grainfield::simulate;

template <class Work>
void report(const char* name, int repeats, Work&& work) {
    std::vector<double> times;
    for (int i = 0; i < repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        times.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count());
    }
    std::sort(times.begin(), times.end());
    std::printf("%-28s median %9.1f ms, least %9.1f ms\n", name, times[times.size() / 2],
                times.front());
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

}  // namespace

int main(int argc, char** argv) {
    const bool trace = argc > 1 && std::strcmp(argv[1], "raytrace") == 0;
    RenderOptions options;
    const View view(options.view, {{0, 0}, {100, 100}, {}, 1.94}, 1.94);
    const Camera camera(options, view, 1, trace ? 2 : 1);
    const View fine = camera.radiance_view(view);
    if (trace) {
        const SphereScene scene = layer(false);
        RaytraceOptics optics(options.raytrace, 2);
        report("raytrace, 2 threads", 1, [&] { optics.radiance(scene, fine); });
        std::printf("  %.2f rays a pixel of the frame, %.2f samples\n",
                    optics.cost().rays / (1600.0 * 1600), optics.cost().samples / (1600.0 * 1600));
        return 0;
    }
    for (const bool crystal : {false, true}) {
        const SphereScene scene = layer(crystal);
        SilhouetteOptics optics({}, 1);
        report(crystal ? "silhouette, s = .81 a" : "silhouette, s = .924 a", 7,
               [&] { optics.radiance(scene, view); });
        report("  on the camera's fine grid", 7, [&] { optics.radiance(scene, fine); });
        const Image radiance = optics.radiance(scene, fine);
        report("  blur and light", 7, [&] { static_cast<void>(camera.exposure(radiance)); });
        const Image exposure = camera.exposure(radiance);
        report("  sensor", 7, [&] { static_cast<void>(camera.develop(exposure, 1)); });
    }
    return 0;
}
