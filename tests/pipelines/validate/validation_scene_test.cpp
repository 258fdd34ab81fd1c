#include "pipelines/validate/validation_scene.h"

#include <fstream>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

/// A layer small enough to be simulated and drawn in an instant.
SceneOptions small_layer() {
    SceneOptions options;
    options.md.cell.grains = 90;
    options.md.cell.length_x = options.md.cell.length_y = 10;
    options.md.run.periods = 3;
    options.md.run.discard = 2;
    options.md.run.snapshot_every = 0.25;
    options.render.view.scale = 8;
    return options;
}

std::string write_truth(const testing::ScratchFolder& folder, int frames) {
    std::string path = folder / "truth.csv";
    std::ofstream table(path);
    table << "frame,particle,x,y\n";
    for (int f = 0; f < frames; ++f) table << f << ",0,50,60\n";
    return path;
}

TEST(ValidationScene, ThatIsRenderedHasATruthForEachFrame) {
    Job job;
    const ValidationScene scene = open_scene(small_layer(), job);
    ASSERT_NE(scene.rendered, nullptr);
    ASSERT_GT(scene.frames->count(), 2);
    EXPECT_EQ(scene.truth->count(), scene.frames->count());
    EXPECT_EQ(scene.sphere_diameter, 8.0);
    // Where a sphere is, the silhouette is dark; truth and picture agree on the place.
    const Image image = scene.frames->read(0).image;
    double inside = 0, all = 0, spheres = 0;
    for (const Vec2 p : scene.truth->read(0).position) {
        const auto x = static_cast<int>(std::lround(p.x));
        const auto y = static_cast<int>(std::lround(p.y));
        if (x < 0 || y < 0 || x >= image.width() || y >= image.height()) continue;
        inside += static_cast<double>(image(x, y));
        ++spheres;
    }
    for (const float v : image.pixels()) all += static_cast<double>(v);
    ASSERT_GT(spheres, 50);
    EXPECT_LT(inside / spheres, 0.5 * all / static_cast<double>(image.size()));
}

TEST(ValidationScene, IsPlannedWithoutARun) {
    Job job;
    const ValidationScene scene = plan_scene(small_layer(), job);
    EXPECT_EQ(scene.trajectory->count(), 0);
    EXPECT_EQ(scene.sphere_diameter, 8.0);
}

TEST(ValidationScene, OfOneFrameNeedsNoColumnsOfFramesAndIdentities) {
    const testing::ScratchFolder folder;
    const std::vector<std::string> paths = testing::write_disc_sequence(folder, 2);
    SceneOptions options;
    options.truth = folder / "truth.csv";
    std::ofstream(options.truth) << "x_px,y_px\n50,60\n70,80\n";
    Job job;
    job.inputs = {paths.front()};
    const ValidationScene scene = open_scene(options, job);
    EXPECT_EQ(scene.truth->read(0).position, (std::vector<Vec2>{{50, 60}, {70, 80}}));
    EXPECT_EQ(scene.truth->read(0).id, (std::vector<std::int64_t>{0, 1}));
    Job of_two;
    of_two.inputs.assign(paths.begin(), paths.end());
    EXPECT_THROW(open_scene(options, of_two), InputError) << "which frame is not known";
}

TEST(ValidationScene, OfGivenFramesNeedsATruthOfAsMany) {
    const testing::ScratchFolder folder;
    const std::vector<std::string> paths = testing::write_disc_sequence(folder, 3);
    SceneOptions options;
    const auto open = [&] {
        Job job;
        job.inputs.assign(paths.begin(), paths.end());
        return open_scene(options, job);
    };
    EXPECT_THROW(open(), OptionError) << "no truth";
    options.truth = write_truth(folder, 2);
    EXPECT_THROW(open(), InputError) << "two snapshots of three frames";
    options.truth = write_truth(folder, 3);
    const ValidationScene scene = open();
    EXPECT_EQ(scene.rendered, nullptr);
    EXPECT_EQ(scene.frames->count(), 3);
    EXPECT_EQ(scene.truth->read(2).position, (std::vector<Vec2>{{50, 60}}));
}

TEST(ValidationScene, RefusesATruthWithoutFramesAndARunWithoutSnapshots) {
    SceneOptions options = small_layer();
    options.md.run.discard = 4;  // of 3
    Job job;
    EXPECT_THROW(open_scene(options, job), InputError);
    options.truth = "truth.csv";
    EXPECT_THROW(open_scene(options, job), OptionError);
}

}  // namespace
}  // namespace grainfield::pipelines
