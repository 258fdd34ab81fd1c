// How fast, and how far from the truth? Run time with error and recall beside it, on the scenes of
// 1600² px, D = 16 px, w = 1.2 px, 2 % noise: isolated discs (I), a liquid (A), a crystal patch of
// projected spacing 0.78 D in a liquid (C). First argument: scene, second: threads. Warm: a film of
// them in which the liquid moves by about 0.05 D per axis and frame, every frame from the one
// before.
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/support/layer_frames.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/score/position_score.h"

namespace {

using namespace grainfield;
using namespace grainfield::tracking;

constexpr int kSize = 1600;
constexpr std::array<const char*, 3> kNames{"I isolated", "A liquid", "C crystal in liquid"};
/// Joint Cramér–Rao bounds per axis [px]; for C that of the liquid.
constexpr std::array<double, 3> kBounds{0.00757, 0.00835, 0.0084};

testing::CrystalPatch patch() {
    testing::CrystalPatch patch;
    patch.radius = 0.25;
    patch.spacing = 0.78;
    patch.clearance = 1;
    return patch;
}

testing::LayerScene scene_of(int which) {
    if (which == 0) return testing::isolated_discs(kSize, kSize, 16, 32, 1);
    if (which == 1) return testing::hard_disc_liquid(kSize, kSize, 16, 0.72, 1);
    return testing::crystal_in_liquid(kSize, kSize, 16, 0.72, patch(), 1);
}

struct Case {
    testing::LayerScene scene;
    Image frame;
    Calibration calibration;
};

const Case& prepared(int which) {
    static std::array<std::optional<Case>, 3> cases;
    auto& slot = cases[static_cast<std::size_t>(which)];
    if (!slot) {
        testing::LayerScene scene = scene_of(which);
        Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 1);
        RunPlan plan;
        Calibration calibration = *calibrate(frame, {}, {}, {}, 2, plan);
        slot = Case{std::move(scene), std::move(frame), std::move(calibration)};
    }
    return *slot;
}

void calibrate_frame(benchmark::State& state) {
    const Case& c = prepared(static_cast<int>(state.range(0)));
    state.SetLabel(kNames[static_cast<std::size_t>(state.range(0))]);
    for (auto _ : state) {
        RunPlan plan;
        benchmark::DoNotOptimize(
            calibrate(c.frame, {}, {}, {}, static_cast<int>(state.range(1)), plan));
    }
}

void report(benchmark::State& state, std::size_t which, const Located& found,
            const testing::LayerScene& scene) {
    const auto& truth = scene.position;
    const auto crystal = truth.begin() + static_cast<std::ptrdiff_t>(scene.crystal_begin);
    const auto all = score_positions(found.position, truth, 4, kSize, kSize, 16);
    const auto liquid =
        score_positions(found.position, {truth.begin(), crystal}, 4, kSize, kSize, 16);
    state.counters["spheres"] = static_cast<double>(truth.size());
    state.counters["missed"] = all.missed;
    state.counters["false"] = all.spurious;
    state.counters["rms_liquid_px"] = liquid.rms;
    state.counters["over_bound"] = liquid.rms / kBounds[which];
    if (crystal != truth.end()) {
        state.counters["rms_crystal_px"] =
            score_positions(found.position, {crystal, truth.end()}, 4, kSize, kSize, 16).rms;
    }
}

void locate_cold(benchmark::State& state) {
    const auto which = static_cast<std::size_t>(state.range(0));
    const Case& c = prepared(static_cast<int>(which));
    state.SetLabel(kNames[which]);
    Locator locator(kSize, kSize, c.calibration.model.disc, static_cast<int>(state.range(1)));
    Located found;
    Image darkness;
    for (auto _ : state) {
        c.calibration.model.darkness(c.frame, {}, darkness, static_cast<int>(state.range(1)));
        found = locator.locate(darkness, {}, {});
    }
    report(state, which, found, c.scene);
}

/// Back and forth, so that each frame follows one of its neighbours.
void locate_warm(benchmark::State& state) {
    constexpr std::size_t kFrames = 6;
    const auto which = static_cast<std::size_t>(state.range(0));
    const Case& c = prepared(static_cast<int>(which));
    state.SetLabel(kNames[which]);
    const ImageModel& model = c.calibration.model;
    std::vector<testing::LayerScene> scenes{c.scene};
    std::vector<Image> frames{c.frame};
    testing::LayerMotion motion(c.scene, patch(), 0.8, 1);
    double squared_step = 0;
    while (frames.size() < kFrames) {
        motion.advance();
        squared_step = 0;
        for (std::size_t i = 0; i < c.scene.position.size(); ++i) {
            squared_step += squared_norm(motion.scene().position[i] - scenes.back().position[i]);
        }
        scenes.push_back(motion.scene());
        frames.push_back(testing::tanh_frame(motion.scene(), 16, 1.2, 0.02, frames.size() + 1));
    }
    const double step = std::sqrt(squared_step / static_cast<double>(c.scene.position.size()));
    Locator locator(kSize, kSize, model.disc, static_cast<int>(state.range(1)));
    Located found = locator.locate(model.darkness(frames[0]), {}, {});
    Image darkness;
    std::size_t at = 0;
    std::size_t turn = 0;
    for (auto _ : state) {
        turn = (turn + 1) % (2 * kFrames - 2);
        at = turn < kFrames ? turn : 2 * kFrames - 2 - turn;
        const std::vector<Vec2> start = found.fitted;
        model.darkness(frames[at], {}, darkness, static_cast<int>(state.range(1)));
        found = locator.locate(darkness, {}, {}, start, step);
    }
    report(state, which, found, scenes[at]);
    state.counters["step_px_axis"] = step / std::sqrt(2.0);
    state.counters["steps"] =
        static_cast<double>(found.steps) / static_cast<double>(found.fitted.size());
    state.counters["coarse_steps"] =
        static_cast<double>(found.coarse_steps) / static_cast<double>(found.fitted.size());
}

BENCHMARK(calibrate_frame)
    ->Args({1, 1})
    ->Args({1, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(locate_cold)
    ->ArgsProduct({{0, 1, 2}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(locate_warm)->ArgsProduct({{1, 2}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
