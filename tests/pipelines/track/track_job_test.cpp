#include "pipelines/track/track_job.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/trajectory_file.h"
#include "pipelines/track/stored_bias.h"
#include "pipelines/track/stored_binning.h"
#include "tests/pipelines/interrupted_run.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/position_score.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

namespace fs = std::filesystem;

class TrackJob : public ::testing::Test {
 protected:
    TrackJobResult run(const TrackJobOptions& options, int frames) {
        Job job;
        job.inputs.assign(paths_.begin(), paths_.begin() + frames);
        return track_film(options, job);
    }
    static TrackJobOptions to(const std::string& output) {
        TrackJobOptions options;
        options.output = output;
        return options;
    }
    static std::vector<Vec2> truth(int frame) {
        std::vector<Vec2> position = testing::few_discs().position;
        for (Vec2& p : position) p += Vec2{0.3, -0.2} * frame;
        return position;
    }

    testing::ScratchFolder film_, folder_;
    const std::vector<std::string> paths_ = testing::write_disc_sequence(film_, 30);
    const std::string output_ = folder_ / "t.h5";
};

// Noise of 2 % moves an isolated disc of 9 px by 0.01 px per axis (its bound); a tenth of a pixel
// is ten of that.
TEST_F(TrackJob, WritesWhereTheDiscsAreWithTheCalibrationAndThePictures) {
    TrackJobOptions options = to(output_);
    options.previews = 2;
    const TrackJobResult result = run(options, 4);
    EXPECT_EQ(result.summary.frames, 4);
    ASSERT_TRUE(result.spheres);
    EXPECT_NEAR(result.spheres->diameter, testing::kApparentDiameter, 0.1);
    io::TrajectoryFile file(output_);
    ASSERT_EQ(file.count(), 4);
    for (int f = 0; f < 4; ++f) {
        const Snapshot found = file.read(f);
        const auto score =
            testing::score_positions(found.position, truth(f), 4, testing::kPictureSize,
                                     testing::kPictureSize, testing::kApparentDiameter);
        EXPECT_EQ(score.missed + score.spurious, 0) << f;
        EXPECT_LT(score.rms, 0.1) << f;
        EXPECT_EQ(found.id, file.read(0).id) << "nothing comes or goes";
    }
    EXPECT_EQ(file.previews().size(), 2U);
    ASSERT_EQ(file.curves().size(), 3U);
    EXPECT_EQ(file.curves()[0].find("apparent_diameter")->values[0], result.spheres->diameter);
    EXPECT_EQ(stored_bias(file.curves()), result.bias) << "why there is none";
    EXPECT_EQ(stored_binning(file.curves()), result.spheres->binning);
    EXPECT_EQ(folder_.entries(), 1U) << "no checkpoint and no log";
}

TEST_F(TrackJob, ThatWasInterruptedEndsInTheSamePositions) {
    TrackJobOptions options = to(output_);
    options.resume.every = std::chrono::seconds(0);
    EXPECT_EXIT(testing::interrupt_once_saved(output_, [&] { return run(options, 30).signal; }),
                ::testing::ExitedWithCode(130), "");
    ASSERT_TRUE(fs::exists(output_ + ".checkpoint"));
    EXPECT_LT(io::TrajectoryFile(output_).count(), 30) << "what was done is a complete file";
    EXPECT_THROW(run(options, 30), OutputError) << "not begun anew without being told to";
    options.resume.resume = true;
    run(options, 30);
    EXPECT_EQ(folder_.entries(), 1U);
    run(to(folder_ / "whole.h5"), 30);
    io::TrajectoryFile resumed(output_), whole(folder_ / "whole.h5");
    ASSERT_EQ(resumed.count(), 30);
    for (int f = 0; f < 30; ++f) {
        EXPECT_EQ(resumed.read(f).position, whole.read(f).position) << f;
        EXPECT_EQ(resumed.read(f).id, whole.read(f).id) << f;
    }
    EXPECT_EQ(resumed.previews().size(), whole.previews().size());
}

TEST_F(TrackJob, OfAnotherFilmDoesNotGoOnFromACheckpoint) {
    TrackJobOptions options = to(output_);
    options.resume.every = std::chrono::seconds(0);
    EXPECT_EXIT(testing::interrupt_once_saved(output_, [&] { return run(options, 30).signal; }),
                ::testing::ExitedWithCode(130), "");
    options.resume.resume = true;
    EXPECT_THROW(run(options, 20), InputError);
    options.tracking.link.memory += 1;
    EXPECT_THROW(run(options, 30), InputError);
    options.tracking.link.memory -= 1;
    options.film.strict = true;  // says what to refuse, not what comes out
    EXPECT_EQ(run(options, 30).signal, 0);
}

TEST_F(TrackJob, WarnsThatLengthsAreInDiscsUnlessTheSphereIsKnown) {
    const auto codes = [&](std::optional<double> sphere) {
        TrackJobOptions options = to(output_);
        options.tracking.sphere_diameter = sphere;
        Job job;
        job.inputs = {paths_[0]};
        job.overwrite = Overwrite::force;
        track_film(options, job);
        std::vector<WarningCode> found;
        for (const Warning& warning : job.plan.warnings()) found.push_back(warning.code);
        return found;
    };
    EXPECT_THAT(codes(std::nullopt), ::testing::Contains(WarningCode::apparent_diameter));
    EXPECT_THAT(codes(10.0), ::testing::Not(::testing::Contains(WarningCode::apparent_diameter)));
}

}  // namespace
}  // namespace grainfield::pipelines
