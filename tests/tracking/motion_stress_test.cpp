// Films that push the tracker to where it may break: camera, clock and particles that do not
// behave. Frames by a camera that knows nothing of the tracker's image model.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/memory_frames.h"
#include "core/support/random.h"
#include "tests/support/collect.h"
#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"
#include "tracking/score/track_scores.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

using testing::Collect;
using testing::LayerScene;
using testing::score_positions;

constexpr int kSide = 300;
constexpr double kDiameter = 12;

/// What was true of each frame, and the frame.
struct Film {
    std::vector<Frame> frames;
    std::vector<IdentifiedFrame> truth;

    /// Spheres outside the frame exist in the scene and are not in the truth.
    void add(const LayerScene& scene, const std::vector<std::int64_t>& ids) {
        Frame frame;
        frame.image = testing::camera_frame(scene, {}, frames.size());
        frames.push_back(std::move(frame));
        IdentifiedFrame seen;
        for (std::size_t i = 0; i < scene.position.size(); ++i) {
            const Vec2 p = scene.position[i];
            if (std::min({p.x, p.y, kSide - 1 - p.x, kSide - 1 - p.y}) < kDiameter / 2) continue;
            seen.id.push_back(ids[i]);
            seen.position.push_back(p);
        }
        truth.push_back(std::move(seen));
    }
};

std::vector<std::int64_t> ids_from(std::int64_t first, std::size_t count) {
    std::vector<std::int64_t> ids(count);
    for (std::size_t i = 0; i < count; ++i) ids[i] = first + static_cast<std::int64_t>(i);
    return ids;
}

/// A liquid with Brownian steps of `step` [D] per axis, all moved by `shift(frame)` [px].
template <class Shift>
Film moving_liquid(int frames, double area_fraction, double step, Shift&& shift) {
    const LayerScene start = testing::hard_disc_liquid(kSide, kSide, kDiameter, area_fraction, 3);
    RandomStream random(3, "motion stress");
    Film film;
    std::vector<Vec2> places = start.position;
    for (int f = 0; f < frames; ++f) {
        LayerScene scene = start;
        for (std::size_t i = 0; i < places.size(); ++i) {
            // About fixed places: discs stay apart.
            scene.position[i] =
                places[i] + shift(f) +
                (step / std::sqrt(2.0) * kDiameter) * Vec2{random.normal(), random.normal()};
        }
        film.add(scene, ids_from(0, places.size()));
    }
    return film;
}

struct Tracked {
    std::vector<Snapshot> snapshots;
    std::vector<Warning> warnings;
    TrackSummary summary;

    bool warned_of(const std::string& words) const {
        return std::any_of(warnings.begin(), warnings.end(), [&](const Warning& w) {
            return w.text.find(words) != std::string::npos;
        });
    }
};

Tracked tracked(const Film& film, const TrackOptions& options = {}) {
    MemoryFrames source(testing::numbered(film.frames));
    Collect sink;
    RunPlan plan;
    Tracker tracker(source, options, plan);
    Progress progress("tracking", source.count(), "frames", Verbosity::quiet);
    Tracked result;
    result.summary = tracker.run(sink, progress);
    result.snapshots = sink.snapshots;
    result.warnings = plan.warnings();
    return result;
}

TrackScores scored(const Tracked& result, const Film& film) {
    std::vector<IdentifiedFrame> found(film.frames.size());
    for (const Snapshot& s : result.snapshots) {
        found[static_cast<std::size_t>(s.frame)] = {s.id, s.position};
    }
    return score_tracks(found, film.truth, kDiameter / 4);
}

double recall(const Tracked& result, const Film& film, std::size_t frame) {
    for (const Snapshot& s : result.snapshots) {
        if (s.frame != static_cast<std::int64_t>(frame)) continue;
        return score_positions(s.position, film.truth[frame].position, kDiameter / 4, kSide, kSide,
                               0)
            .recall();
    }
    return 0;
}

Vec2 at_rest(int) {
    return {};
}

TEST(MotionStress, ACameraThatShakesLosesNoIdentity) {
    // 0.15 D RMS per axis on top of steps of 0.05 D: well below half the spacing.
    RandomStream random(1, "shaking camera");
    std::vector<Vec2> shifts(8);
    for (Vec2& s : shifts) s = 0.15 * kDiameter * Vec2{random.normal(), random.normal()};
    const Film film =
        moving_liquid(8, 0.55, 0.05, [&](int f) { return shifts[static_cast<std::size_t>(f)]; });
    const TrackScores scores = scored(tracked(film), film);
    EXPECT_GT(scores.links, 1500);
    EXPECT_EQ(scores.wrong_links, 0);
    EXPECT_LE(scores.switches, 2);
    // Errors of 0.1 px on average leave 0.97 of 1 at ε = 3 px.
    EXPECT_GT(scores.alpha, 0.95);
}

TEST(MotionStress, ACameraThatDriftsByMoreThanHalfASpacingIsFollowedByTheDriftPredictor) {
    // 0.6 D a frame, reached within three frames.
    const Film film = moving_liquid(10, 0.55, 0.04, [](int f) {
        return Vec2{kDiameter * (f < 3 ? 0.1 * f * f : 0.9 + 0.6 * (f - 3)), 0};
    });
    TrackOptions options;
    options.link.predictor = Predictor::drift;
    const Tracked followed = tracked(film, options);
    const TrackScores scores = scored(followed, film);
    EXPECT_GT(scores.links, 1500);
    EXPECT_GT(scores.correct_link_fraction(), 0.99);
    for (std::size_t f = 0; f < 10; ++f) EXPECT_GT(recall(followed, film, f), 0.99) << f;
}

TEST(MotionStress, StepsAboveHalfTheSpacingAreWarnedOf) {
    // Without a predictor the same drift gives wrong identities; positions are right all the same.
    const Film film = moving_liquid(5, 0.55, 0.04, [](int f) {
        return Vec2{0.7 * kDiameter * f, 0};
    });
    const Tracked result = tracked(film);
    EXPECT_TRUE(result.warned_of("identities are doubtful"));
    for (std::size_t f = 0; f < 5; ++f) EXPECT_GT(recall(result, film, f), 0.99) << f;
}

TEST(MotionStress, AMissingFrameInTheMiddleCostsNoIdentity) {
    Film film = moving_liquid(7, 0.55, 0.06, at_rest);
    film.frames[3].status = FrameStatus::missing;
    film.frames[3].image = Image();
    film.truth[3] = {};
    const Tracked result = tracked(film);
    EXPECT_EQ(result.summary.frames_missing, 1);
    EXPECT_EQ(result.snapshots.size(), 6U);
    const TrackScores scores = scored(result, film);
    EXPECT_GT(scores.links, 1000);
    EXPECT_EQ(scores.switches, 0);
    EXPECT_EQ(scores.wrong_links, 0);
}

TEST(MotionStress, EveryFrameTwiceIsTrackedOnceAndSaid) {
    const Film once = moving_liquid(4, 0.55, 0.06, at_rest);
    Film twice;
    for (std::size_t f = 0; f < 4; ++f) {
        for (int copy = 0; copy < 2; ++copy) {
            twice.frames.push_back(once.frames[f]);
            twice.truth.push_back(once.truth[f]);
        }
    }
    const Tracked result = tracked(twice);
    EXPECT_EQ(result.summary.repeated, 4);
    EXPECT_TRUE(result.warned_of("repeat the one before"));
    for (std::size_t f = 0; f < 8; f += 2) {
        EXPECT_EQ(result.snapshots[f].position, result.snapshots[f + 1].position);
        EXPECT_EQ(result.snapshots[f].id, result.snapshots[f + 1].id);
    }
    EXPECT_EQ(scored(result, twice).wrong_links, 0);
}

TEST(MotionStress, AllSpheresLeaveAndOthersCome) {
    // Three frames, two of the empty cell (light, dust and noise are still there), three with other
    // spheres.
    Film film = moving_liquid(3, 0.55, 0.05, at_rest);
    LayerScene empty{kSide, kSide, kDiameter, {}, {}, 0};
    for (int f = 0; f < 2; ++f) film.add(empty, {});
    const LayerScene others = testing::hard_disc_liquid(kSide, kSide, kDiameter, 0.4, 9);
    for (int f = 0; f < 3; ++f) film.add(others, ids_from(10000, others.position.size()));
    const Tracked result = tracked(film);
    ASSERT_EQ(result.snapshots.size(), 8U);
    EXPECT_EQ(result.snapshots[3].size(), 0U);
    EXPECT_EQ(result.snapshots[4].size(), 0U);
    for (const std::size_t f : {0U, 1U, 2U, 5U, 6U, 7U}) EXPECT_GT(recall(result, film, f), 0.99);
}

TEST(MotionStress, TheNumberJumpsFromAQuarterToAll) {
    // Each of the first spheres keeps its identity, all that appear are found at once.
    const LayerScene all = testing::hard_disc_liquid(kSide, kSide, kDiameter, 0.55, 3);
    LayerScene few = all;
    std::vector<std::int64_t> few_ids;
    few.position.clear();
    for (std::size_t i = 0; i < all.position.size(); i += 4) {
        few.position.push_back(all.position[i]);
        few_ids.push_back(static_cast<std::int64_t>(i));
    }
    Film film;
    for (int f = 0; f < 3; ++f) film.add(few, few_ids);
    for (int f = 0; f < 3; ++f) film.add(all, ids_from(0, all.position.size()));
    for (int f = 0; f < 2; ++f) film.add(few, few_ids);
    const Tracked result = tracked(film);
    for (std::size_t f = 0; f < 8; ++f) {
        EXPECT_GT(recall(result, film, f), 0.995) << f;
        const double found = static_cast<double>(result.snapshots[f].size());
        const double there = static_cast<double>((f < 3 || f > 5 ? few : all).position.size());
        EXPECT_NEAR(found / there, 1, 0.01) << f;
    }
    const TrackScores scores = scored(result, film);
    EXPECT_EQ(scores.wrong_links, 0);
    EXPECT_EQ(scores.switches, 0);
}

}  // namespace
}  // namespace grainfield::tracking
