// How fast, and how far from the truth? Run time with error and recall beside it, on the scenes of
// 1600² px, D = 16 px, w = 1.2 px: isolated discs (I), a liquid (A), a crystal patch of projected
// spacing 0.78 D in a liquid (C) and one of 0.72 D, whose holes are all but closed (B). First
// argument: scene, second: threads, third: noise [%]. Errors are given over the joint Cramér–Rao
// bound of the very frame they are made on. Warm: a film of them in which the liquid moves by about
// 0.05 D per axis and frame, every frame from the one before. Phases: many frames of one scene with
// new noise; the mean error of the spheres at each of eight sub-pixel phases.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/support/layer_frames.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/score/detection_scores.h"
#include "tracking/score/position_bounds.h"

namespace {

using namespace grainfield;
using namespace grainfield::tracking;

constexpr int kSize = 1600;
constexpr std::array<const char*, 4> kNames{"I isolated", "A liquid", "C crystal in liquid",
                                            "B closed crystal in liquid"};
constexpr DiscProfile kDisc{16, 1.2};
constexpr double kGate = 4;  // [px]

testing::CrystalPatch patch(double spacing = 0.78) {
    testing::CrystalPatch patch;
    patch.radius = 0.25;
    patch.spacing = spacing;
    patch.clearance = 1;
    return patch;
}

testing::LayerScene scene_of(int which) {
    if (which == 0) return testing::isolated_discs(kSize, kSize, 16, 32, 1);
    if (which == 1) return testing::hard_disc_liquid(kSize, kSize, 16, 0.72, 1);
    return testing::crystal_in_liquid(kSize, kSize, 16, 0.72, which == 2 ? patch() : patch(0.72),
                                      1);
}

Image frame_of(const testing::LayerScene& scene, int percent, std::uint64_t seed) {
    return testing::tanh_frame(scene, kDisc.diameter, kDisc.edge_width, 0.01 * percent, seed);
}

struct Case {
    testing::LayerScene scene;
    Image frame;
    Calibration calibration;
};

const Case& prepared(int which, int percent) {
    static std::map<std::pair<int, int>, Case> cases;
    const auto found = cases.find({which, percent});
    if (found != cases.end()) return found->second;
    testing::LayerScene scene = scene_of(which);
    Image frame = frame_of(scene, percent, 1);
    RunPlan plan;
    Calibration calibration = *calibrate(frame, {}, {}, {}, 2, plan);
    return cases
        .emplace(std::pair{which, percent},
                 Case{std::move(scene), std::move(frame), std::move(calibration)})
        .first->second;
}

void calibrate_frame(benchmark::State& state) {
    const Case& c = prepared(static_cast<int>(state.range(0)), 2);
    state.SetLabel(kNames[static_cast<std::size_t>(state.range(0))]);
    for (auto _ : state) {
        RunPlan plan;
        benchmark::DoNotOptimize(
            calibrate(c.frame, {}, {}, {}, static_cast<int>(state.range(1)), plan));
    }
}

/// Spheres at least D inside the frame: all, those of the liquid, those of the crystal.
TruthFrame truth_of(const testing::LayerScene& scene, int percent) {
    TruthFrame truth;
    truth.position = scene.position;
    for (std::size_t i = 0; i < scene.position.size(); ++i) {
        const Vec2 p = scene.position[i];
        const double inside = std::min(std::min(p.x, p.y), kSize - 1 - std::max(p.x, p.y));
        const std::uint64_t matter = i < scene.crystal_begin ? 2U : 4U;
        truth.classes.push_back(inside < kDisc.diameter ? 0U : 1U | matter);
    }
    truth.bound = position_bounds(scene.position, kDisc, kSize, kSize, 0.01 * percent, 2);
    return truth;
}

DetectionScores no_scores() {
    return {{"all", "liquid", "crystal"}, kGate};
}

void report(benchmark::State& state, const DetectionScores& scores) {
    const ClassScore& all = scores.find("all");
    state.counters["spheres"] =
        static_cast<double>(all.matched + all.missed) / static_cast<double>(scores.frames());
    state.counters["missed"] = static_cast<double>(all.missed);
    state.counters["false"] = static_cast<double>(all.spurious);
    for (const char* name : {"liquid", "crystal"}) {
        const ClassScore& score = scores.find(name);
        if (score.matched == 0) continue;
        const std::string suffix = std::string("_") + name;
        state.counters["rms_px" + suffix] = score.rmse_per_axis();
        state.counters["bound_px" + suffix] = score.bound();
        state.counters["over_bound" + suffix] = score.bound_ratio();
    }
}

/// The darkness of a frame, row by row, as the tracker asks for it.
JointFit::WriteRow rows_of(const ImageModel& model, const Image& frame) {
    return [&](int y, float* row) { model.darkness_row(frame, {}, y, row); };
}

void locate_cold(benchmark::State& state) {
    const auto which = static_cast<int>(state.range(0));
    const auto threads = static_cast<int>(state.range(1));
    const auto percent = static_cast<int>(state.range(2));
    const Case& c = prepared(which, percent);
    state.SetLabel(kNames[static_cast<std::size_t>(which)]);
    Locator locator(kSize, kSize, c.calibration.model.disc, threads);
    Located found;
    for (auto _ : state) found = locator.locate(rows_of(c.calibration.model, c.frame), {}, {});
    DetectionScores scores = no_scores();
    scores.add(truth_of(c.scene, percent), found.position, {});
    report(state, scores);
}

/// Mean error at each of eight sub-pixel phases of the true position, in units of the bound.
class PhaseBias {
 public:
    void add(const TruthFrame& truth, const std::vector<int>& partner,
             const std::vector<Vec2>& found) {
        for (std::size_t i = 0; i < truth.position.size(); ++i) {
            const Vec2 bound = truth.bound[i];
            // As DetectionScores: beyond a third of the gate it decides, not the tracker.
            const bool is_resolved = bound.x < kGate / 3 && bound.y < kGate / 3;
            if (partner[i] < 0 || truth.classes[i] == 0 || !is_resolved) continue;
            const Vec2 p = truth.position[i];
            const Vec2 error = found[static_cast<std::size_t>(partner[i])] - p;
            add(0, p.x, error.x / bound.x);
            add(1, p.y, error.y / bound.y);
        }
    }
    /// The largest |mean|, and the standard error of one mean.
    std::pair<double, double> worst() const {
        double worst = 0;
        double squares = 0;
        for (const auto& axis : bins_) {
            for (const Bin& bin : axis) {
                const double mean = bin.sum / bin.count;
                worst = std::max(worst, std::abs(mean));
                squares += (bin.squares / bin.count - mean * mean) / bin.count / (2 * kPhases);
            }
        }
        return {worst, std::sqrt(squares)};
    }

 private:
    static constexpr std::size_t kPhases = 8;
    struct Bin {
        double count = 0, sum = 0, squares = 0;
    };
    void add(std::size_t axis, double x, double error) {
        const double phase = x + 0.5 - std::floor(x + 0.5);
        Bin& bin = bins_[axis][std::min(static_cast<std::size_t>(kPhases * phase), kPhases - 1)];
        bin.count += 1;
        bin.sum += error;
        bin.squares += error * error;
    }
    std::array<std::array<Bin, kPhases>, 2> bins_{};
};

void phases(benchmark::State& state) {
    const auto which = static_cast<int>(state.range(0));
    const auto percent = static_cast<int>(state.range(1));
    const Case& c = prepared(which, percent);
    state.SetLabel(kNames[static_cast<std::size_t>(which)]);
    const TruthFrame truth = truth_of(c.scene, percent);
    Locator locator(kSize, kSize, c.calibration.model.disc, 1);
    DetectionScores scores = no_scores();
    PhaseBias bias;
    // As many that chance alone is a fifth of 0.05 of the bound at each phase.
    const auto frames = static_cast<std::uint64_t>(
        std::ceil(8 * 10000 / static_cast<double>(c.scene.position.size())));
    for (auto _ : state) {
        for (std::uint64_t seed = 2; seed < 2 + frames; ++seed) {
            const Image darkness = c.calibration.model.darkness(frame_of(c.scene, percent, seed));
            const Located found = locator.locate(darkness, {}, {});
            bias.add(truth, scores.add(truth, found.position, {}).partner, found.position);
        }
    }
    report(state, scores);
    state.counters["frames"] = static_cast<double>(frames);
    const auto [worst, chance] = bias.worst();
    state.counters["worst_bias"] = worst;
    state.counters["chance"] = chance;
}

/// Back and forth, so that each frame follows one of its neighbours.
void locate_warm(benchmark::State& state) {
    constexpr std::size_t kFrames = 6;
    constexpr int kPercent = 2;
    const auto which = static_cast<int>(state.range(0));
    const Case& c = prepared(which, kPercent);
    state.SetLabel(kNames[static_cast<std::size_t>(which)]);
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
        frames.push_back(frame_of(motion.scene(), kPercent, frames.size() + 1));
    }
    const double step = std::sqrt(squared_step / static_cast<double>(c.scene.position.size()));
    Locator locator(kSize, kSize, model.disc, static_cast<int>(state.range(1)));
    Located found = locator.locate(model.darkness(frames[0]), {}, {});
    std::size_t turn = 0;
    const auto next = [&] {
        turn = (turn + 1) % (2 * kFrames - 2);
        const std::size_t at = turn < kFrames ? turn : 2 * kFrames - 2 - turn;
        const std::vector<Vec2> start = found.fitted;
        found = locator.locate(rows_of(model, frames[at]), {}, {}, start, step);
        return at;
    };
    for (auto _ : state) next();
    // There and back once more, not timed.
    DetectionScores scores = no_scores();
    std::vector<TruthFrame> truth;
    for (const auto& scene : scenes) truth.push_back(truth_of(scene, kPercent));
    for (std::size_t i = 0; i < 2 * kFrames - 2; ++i) {
        const std::size_t at = next();
        scores.add(truth[at], found.position, {});
    }
    report(state, scores);
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
    ->ArgsProduct({{0, 1, 2, 3}, {1, 2}, {2}})
    ->ArgsProduct({{0, 1, 2}, {1}, {5}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(phases)->ArgsProduct({{0, 1, 2}, {2, 5}})->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(locate_warm)->ArgsProduct({{1, 2}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
