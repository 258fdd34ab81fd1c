// Linking 11,700 spheres: time a frame beside the share of wrong links and the scores of tracks.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/support/random.h"
#include "tests/support/layer_frames.h"
#include "tracking/link/linker.h"
#include "tracking/score/track_scores.h"

namespace {

using namespace grainfield;
using tracking::IdentifiedFrame;

constexpr int kFrames = 12;
constexpr int kMemory = 3;

enum Matter { liquid, crystal };

/// 11,700 spheres: a liquid of .72, or a bilayer patch of spacing .78 D in such a liquid.
const testing::LayerScene& scene_of(Matter matter) {
    static std::map<Matter, testing::LayerScene> scenes;
    auto [at, is_new] = scenes.try_emplace(matter);
    if (is_new) {
        testing::CrystalPatch patch;
        patch.radius = 0.25;
        patch.spacing = 0.78;
        patch.jitter = 0;
        at->second = matter == liquid
                         ? testing::hard_disc_liquid(1600, 1600, 14.2, 0.72, 1)
                         : testing::crystal_in_liquid(1600, 1600, 15.8, 0.72, patch, 1);
    }
    return at->second;
}

/// Spheres rattling about their places with steps of the given RMS between frames; each missing in
/// a share of the frames.
std::vector<IdentifiedFrame> movie(const testing::LayerScene& scene, double step, double dropouts) {
    std::vector<IdentifiedFrame> frames(kFrames);
    for (std::size_t f = 0; f < kFrames; ++f) {
        RandomStream random(1, "linker bench", f);
        for (std::size_t i = 0; i < scene.position.size(); ++i) {
            const Vec2 p = scene.position[i] + (step / 2) * Vec2{random.normal(), random.normal()};
            if (random.uniform() < dropouts) continue;
            frames[f].id.push_back(static_cast<std::int64_t>(i));
            frames[f].position.push_back(p);
        }
    }
    return frames;
}

/// What the linker did before it solved subnets: nearest pairs first.
class NearestFirst {
 public:
    explicit NearestFirst(double range) : range_(range) {}

    std::vector<std::int64_t> link(std::int64_t frame, const std::vector<Vec2>& positions) {
        std::erase_if(tracks_, [&](const auto& t) { return frame - t.frame > kMemory + 1; });
        std::vector<Vec2> places;
        for (const tracking::Track& t : tracks_) places.push_back(t.position);
        auto pairs = tracking::find_candidates({places, {}}, {positions, {}}, range_, {}).pairs;
        std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
            return std::tie(a.cost, a.row, a.column) < std::tie(b.cost, b.row, b.column);
        });
        std::vector<std::int64_t> ids(positions.size(), -1);
        for (const auto& p : pairs) {
            tracking::Track& t = tracks_[p.row];
            if (t.frame == frame || ids[p.column] >= 0) continue;
            ids[p.column] = t.id;
            t.frame = frame;
            t.position = positions[p.column];
        }
        for (std::size_t i = 0; i < positions.size(); ++i) {
            if (ids[i] >= 0) continue;
            ids[i] = next_id_++;
            tracks_.push_back({ids[i], frame, positions[i], {}, {}});
        }
        return ids;
    }

 private:
    double range_;
    std::int64_t next_id_ = 0;
    std::vector<tracking::Track> tracks_;
};

template <class AnyLinker>
tracking::TrackScores scores_of(AnyLinker& linker, const std::vector<IdentifiedFrame>& truth,
                                double diameter) {
    std::vector<IdentifiedFrame> found;
    for (std::size_t f = 0; f < truth.size(); ++f) {
        found.push_back(
            {linker.link(static_cast<std::int64_t>(f), truth[f].position), truth[f].position});
    }
    return tracking::score_tracks(found, truth, 0.25 * diameter);
}

/// Arguments: matter, step and search range in hundredths of D (0: as the linker chooses), dropouts
/// in per cent.
void link_frame(benchmark::State& state) {
    const auto& scene = scene_of(static_cast<Matter>(state.range(0)));
    const double diameter = scene.diameter;
    const auto truth = movie(scene, 0.01 * static_cast<double>(state.range(1)) * diameter,
                             0.01 * static_cast<double>(state.range(3)));
    tracking::LinkOptions options;
    options.memory = kMemory;
    if (state.range(2) > 0) {
        options.search_range = 0.01 * static_cast<double>(state.range(2)) * diameter;
    }
    // The errors that tracking hands over; all alike, so that they cost time and change nothing.
    std::vector<std::vector<Vec2>> errors;
    for (const IdentifiedFrame& f : truth) errors.emplace_back(f.id.size(), Vec2{0.01, 0.01});
    tracking::Linker linker(options, diameter);
    std::size_t f = 0;
    for (auto _ : state) {
        if (f == truth.size() || f == 0) {
            state.PauseTiming();
            linker = tracking::Linker(options, diameter);
            linker.link(0, truth[0].position, errors[0]);
            f = 1;
            state.ResumeTiming();
        }
        benchmark::DoNotOptimize(
            linker.link(static_cast<std::int64_t>(f), truth[f].position, errors[f]));
        ++f;
    }
    tracking::Linker scored(options, diameter);
    const auto scores = scores_of(scored, truth, diameter);
    NearestFirst nearest(scored.summary().range);
    const auto before = scores_of(nearest, truth, diameter);
    const auto share = [](const tracking::TrackScores& s) {
        return static_cast<double>(s.switches) / static_cast<double>(s.links);
    };
    state.counters["spheres"] = static_cast<double>(scene.position.size());
    state.counters["range"] = scored.summary().range / diameter;
    state.counters["wrong_links"] = static_cast<double>(scores.wrong_links);
    state.counters["nearest_first_wrong_links"] = static_cast<double>(before.wrong_links);
    state.counters["switch_share"] = share(scores);
    state.counters["nearest_first_switch_share"] = share(before);
    state.counters["alpha"] = scores.alpha;
    state.counters["beta"] = scores.beta;
    state.counters["jsc"] = scores.jaccard_points;
    state.counters["jsc_theta"] = scores.jaccard_tracks;
    state.counters["fragments"] = static_cast<double>(scores.fragments);
    state.counters["links"] = static_cast<double>(scores.links);
    state.counters["largest_subnet"] = static_cast<double>(scored.summary().subnets.largest);
    state.counters["largest_pairs"] = static_cast<double>(scored.summary().subnets.largest_pairs);
    state.counters["cut_subnets"] = static_cast<double>(scored.summary().subnets.reduced);
}

BENCHMARK(link_frame)
    ->ArgNames({"crystal", "step", "range", "dropouts"})
    ->ArgsProduct({{liquid, crystal}, {5, 10, 15, 30, 40}, {0, 50, 100}, {1, 5}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
