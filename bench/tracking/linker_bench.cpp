// Linking 11,700 discs that move .05 D (RMS) a frame; the counter says how many links were wrong.
#include <benchmark/benchmark.h>

#include "core/random.h"
#include "tests/support/layer_frames.h"
#include "tracking/link/linker.h"

namespace {

using namespace grainfield;

void link_frame(benchmark::State& state) {
    const double diameter = 13;
    const double step = static_cast<double>(state.range(0)) / 100 * diameter;
    const auto scene = testing::hard_disc_liquid(1600, 1600, diameter, 0.60, 1);
    tracking::Linker linker(diameter / 2, 0);
    RandomStream random(1, "linker bench");
    std::int64_t frame = 0;
    const auto truth = linker.link(frame++, scene.position);
    double wrong = 0;
    double links = 0;
    for (auto _ : state) {
        state.PauseTiming();
        std::vector<Vec2> moved = scene.position;
        for (Vec2& p : moved) {
            p += (step / std::sqrt(2.0)) * Vec2{random.normal(), random.normal()};
        }
        state.ResumeTiming();
        const auto ids = linker.link(frame++, moved);
        state.PauseTiming();
        for (std::size_t i = 0; i < ids.size(); ++i) wrong += ids[i] != truth[i];
        links += static_cast<double>(ids.size());
        linker = tracking::Linker(diameter / 2, 0);
        frame = 0;
        linker.link(frame++, scene.position);
        state.ResumeTiming();
    }
    state.counters["spheres"] = static_cast<double>(scene.position.size());
    state.counters["wrong_share"] = wrong / links;
}

BENCHMARK(link_frame)->Arg(5)->Arg(15)->Unit(benchmark::kMillisecond);

}  // namespace
