#include "pipelines/validate/validation_scores.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

ScoredView view_of_200() {
    ScoredView view;
    view.width = view.height = 200;
    view.sphere_diameter = 10;
    view.disc = {10, 1};
    return view;
}

Snapshot frame_of(std::vector<std::int64_t> id, std::vector<Vec2> position) {
    Snapshot s;
    s.box = {{-0.5, -0.5}, {200, 200}, {}, 0};
    s.id = std::move(id);
    s.position = std::move(position);
    return s;
}

TEST(ValidationScores, TracksAndPositionsAreScoredOverTheSamePoints) {
    ValidationScores scores(view_of_200());
    for (int f = 0; f < 4; ++f) {
        const double x = 50 + f;
        // Two well inside, one in the border, one where the tracker reports nothing.
        Snapshot truth = frame_of({1, 2, 3, 4}, {{x, 50}, {x, 90}, {6, 60.0 + f}, {1, 120.0 + f}});
        // One missed once; false ones: near an inner one, near the border, beside the outermost.
        Snapshot found = frame_of(
            {11, 12, 13, 14, 15, 16},
            {{x, 50.2}, {x, 90.1}, {6, 60.2 + f}, {x, 98}, {6.1, 67.0 + f}, {3.5, 124.0 + f}});
        if (f == 2) {
            found.id.erase(found.id.begin() + 1);
            found.position.erase(found.position.begin() + 1);
        }
        scores.add(truth, found);
    }
    const auto& all = scores.detection().find("all");
    EXPECT_EQ(all.matched, 7);
    EXPECT_EQ(all.missed, 1);
    EXPECT_EQ(all.spurious, 4);
    const tracking::TrackScores tracks = scores.tracks();
    EXPECT_DOUBLE_EQ(tracks.jaccard_points, all.jaccard()) << "no link is wrong";
    EXPECT_EQ(tracks.links, 5);
    EXPECT_EQ(tracks.fragments, 1);
    EXPECT_EQ(tracks.switches, 0);
    EXPECT_DOUBLE_EQ(tracks.jaccard_tracks, 2.0 / 3) << "two followed, one false";
}

TEST(ValidationScores, ATrackGoesOnThroughTheBorderButNotOutOfTheFrame) {
    // Nearer than D = 10 px is the border, nearer than 2.5 px out of sight.
    for (const bool leaves : {false, true}) {
        ValidationScores scores(view_of_200());
        const std::vector<double> way{20, 12, leaves ? 1.0 : 8.0, 12, 20};
        for (const double x : way) {
            const Snapshot truth = frame_of({1}, {{x, 100}});
            scores.add(truth, x > 2.5 ? frame_of({7}, {{x, 100}}) : frame_of({}, {}));
        }
        const tracking::TrackScores tracks = scores.tracks();
        EXPECT_EQ(tracks.switches, 0);
        EXPECT_EQ(tracks.links, leaves ? 2 : 3) << "a returning particle cannot be recognised";
        EXPECT_DOUBLE_EQ(tracks.jaccard_points, leaves ? 2.0 / 6 : 1.0);
        EXPECT_DOUBLE_EQ(tracks.jaccard_tracks, leaves ? 1.0 / 2 : 1.0);
    }
}

TEST(ValidationScores, ACrossingOfAPeriodicBoundaryEndsATrackWithinTheFrameToo) {
    for (const double period : {0.0, 100.0}) {
        ScoredView view = view_of_200();
        view.span = {period, period};
        ValidationScores scores(view);
        // In a box of 100 px a grain leaves at 130 and another image of it comes in at 30.
        scores.add(frame_of({1}, {{129, 100}}), frame_of({7}, {{129, 100}}));
        scores.add(frame_of({1}, {{30, 100}}), frame_of({8}, {{30, 100}}));
        EXPECT_EQ(scores.tracks().switches, period > 0 ? 0 : 1);
        EXPECT_EQ(scores.tracks().links, period > 0 ? 0 : 1);
    }
}

}  // namespace
}  // namespace grainfield::pipelines
