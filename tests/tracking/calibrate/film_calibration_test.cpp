#include "tracking/calibrate/film_calibration.h"

#include <string>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "tests/support/collect.h"
#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

Frame frame_of(double diameter) {
    const auto scene = testing::hard_disc_liquid(220, 200, diameter, 0.6, 3);
    Frame frame;
    frame.image = testing::tanh_frame(scene, diameter, 1.2, 0.02, 2);
    return frame;
}

FilmCalibration calibrated(FrameSource& source, RunPlan& plan) {
    return calibrate_film(source, {}, {}, {}, {}, 2, plan);
}

TEST(FilmCalibration, IsThatOfTheFirstUsableFrame) {
    Frame black = frame_of(14);
    black.image = Image(220, 200);
    Frame corrupt = frame_of(14);
    corrupt.status = FrameStatus::corrupt;
    MemoryFrames source(testing::numbered({black, corrupt, frame_of(14), frame_of(18)}));
    RunPlan plan;
    const FilmCalibration film = calibrated(source, plan);
    ASSERT_TRUE(film.calibration);
    EXPECT_EQ(film.frame, 2);
    EXPECT_EQ(film.weighed_at, 2);
    EXPECT_NEAR(film.calibration->model.disc.diameter, 14, 0.1);
    EXPECT_FALSE(film.weighed.empty());
}

TEST(FilmCalibration, WithoutAUsableFrameIsEmptyAndSaysOfHowMany) {
    Frame black;
    black.image = Image(64, 48);
    MemoryFrames source(testing::numbered({black, black, black}));
    RunPlan plan;
    EXPECT_FALSE(calibrated(source, plan).calibration);
    ASSERT_FALSE(plan.warnings().empty());
    EXPECT_NE(plan.warnings().back().text.find("no frame to calibrate on among 3 tried"),
              std::string::npos)
        << plan.warnings().back().text;
}

TEST(FilmCalibration, ThatIsKeptMeasuresAnotherFilmAlikeAndWarnsWhereItDoesNotFit) {
    MemoryFrames source(testing::numbered({frame_of(14)}));
    RunPlan plan;
    const FilmCalibration film = calibrated(source, plan);
    ASSERT_TRUE(film.calibration);
    const KeptCalibration kept = to_keep(film, source, {}, 2);

    RunPlan same;
    const FilmCalibration again = use_kept(kept, source, {}, 2, same);
    EXPECT_EQ(again.calibration->model.disc.diameter, film.calibration->model.disc.diameter);
    EXPECT_TRUE(again.calibration->positions.empty());
    EXPECT_EQ(again.frame, -1);
    EXPECT_TRUE(same.warnings().empty());

    MemoryFrames larger(testing::numbered({frame_of(18)}));
    RunPlan other;
    use_kept(kept, larger, {}, 2, other);
    EXPECT_FALSE(other.warnings().empty());
}

TEST(FilmCalibration, ThatIsKeptRefusesFramesOfAnotherSize) {
    MemoryFrames source(testing::numbered({frame_of(14)}));
    RunPlan plan;
    KeptCalibration kept = to_keep(calibrated(source, plan), source, {}, 2);
    kept.width = 100;
    EXPECT_THROW(use_kept(kept, source, {}, 2, plan), InputError);
}

}  // namespace
}  // namespace grainfield::tracking
