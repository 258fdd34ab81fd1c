#include "pipelines/validate/random/random_validation.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using testing::ScratchFolder;

ValidateJobOptions two_scenes(const std::filesystem::path& output) {
    ValidateJobOptions options;
    options.scene.render.optics.select("random");
    options.scene.render.optics.of<RandomOptics>().scenes = 2;
    options.scene.render.optics.of<RandomOptics>().scene_size = SceneSize::small;
    options.report.figures = false;
    options.output = output;
    return options;
}

Job job_of(int threads) {
    Job job;
    job.command = "validate";
    job.threads = threads;
    job.seed = 3;
    return job;
}

TEST(RandomValidation, ScoresDoNotDependOnTheNumberOfThreads) {
    const ScratchFolder folder;
    Job one = job_of(1);
    Job two = job_of(2);
    ValidateJobOptions options = two_scenes(folder / "one.html");
    options.scene.render.optics.of<RandomOptics>().keep = folder / "frames";
    const RandomValidationResult a = run_random_validation(options, one);
    const RandomValidationResult b = run_random_validation(two_scenes(folder / "two.html"), two);
    ASSERT_EQ(a.scenes.size(), 2);
    ASSERT_EQ(b.scenes.size(), 2);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(a.scenes[i].index, static_cast<std::int64_t>(i));
        EXPECT_EQ(a.scenes[i].drawn, b.scenes[i].drawn);
        EXPECT_EQ(a.scenes[i].spheres, b.scenes[i].spheres);
        EXPECT_EQ(a.scenes[i].missed, b.scenes[i].missed);
        EXPECT_EQ(a.scenes[i].spurious, b.scenes[i].spurious);
        EXPECT_EQ(a.scenes[i].rmse, b.scenes[i].rmse);
        EXPECT_EQ(a.scenes[i].pull_rms, b.scenes[i].pull_rms);
    }
    EXPECT_TRUE(std::filesystem::exists(folder / "one.html"));
    for (const char* file : {"000/frame.png", "000/true.csv", "001/optics.toml"}) {
        EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(folder / "frames") / file))
            << file;
    }
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(folder / "frames") / "002"));
}

TEST(RandomValidation, TakesNoFramesAndNoTrajectory) {
    const ScratchFolder folder;
    Job job = job_of(1);
    job.inputs.emplace_back("frame.png");
    EXPECT_THROW(plan_random_validation(two_scenes(folder / "a.html"), job), OptionError);
    Job other = job_of(1);
    ValidateJobOptions options = two_scenes(folder / "a.html");
    options.scene.trajectory = "md.h5";
    EXPECT_THROW(plan_random_validation(options, other), OptionError);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.html"));
}

TEST(RandomValidation, IsNotOneCamera) {
    EXPECT_TRUE(is_random(two_scenes("a.html")));
    EXPECT_FALSE(is_random({}));
    EXPECT_THROW(static_cast<void>(RandomOptics().make(0, 1)), OptionError);
}

}  // namespace
}  // namespace grainfield::pipelines
