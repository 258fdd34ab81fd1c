#include "pipelines/run/run_job.h"

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

TEST(DefaultFolder, IsNamedAfterTheFilm) {
    EXPECT_EQ(default_folder({"films/layer.avi"}), "layer-results");
    EXPECT_EQ(default_folder({"frame_0007.tif"}), "frame_0007-results") << "a single picture";
}

TEST(DefaultFolder, OfASeriesLeavesTheNumbersOut) {
    EXPECT_EQ(default_folder({"a/layer_0000.tif", "a/layer_0001.tif", "a/layer_0010.tif"}),
              "layer-results");
    EXPECT_EQ(default_folder({"run 2.5-000.png", "run 2.5-001.png"}), "run-results");
    EXPECT_EQ(default_folder({"0000.tif", "0001.tif"}), "film-results");
    EXPECT_EQ(default_folder({"a.tif", "b.tif"}), "film-results");
}

}  // namespace
}  // namespace grainfield::pipelines
