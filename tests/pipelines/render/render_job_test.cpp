#include "pipelines/render/render_job.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::pipelines {
namespace {

using Chosen = std::vector<std::int64_t>;

TEST(SnapshotsAtRate, AreAllOfThemWithoutAClock) {
    EXPECT_EQ(snapshots_at_rate(3, 0, 0), (Chosen{0, 1, 2}));
}

TEST(SnapshotsAtRate, AreTheNearestToTheInstantsOfTheCamera) {
    // A snapshot every 10 ms; a frame every 25 ms: 0, 25, 50, 75, rounded away from zero.
    EXPECT_EQ(snapshots_at_rate(9, 0.01, 40), (Chosen{0, 3, 5, 8}));
    EXPECT_EQ(snapshots_at_rate(4, 0.01, 100), (Chosen{0, 1, 2, 3}));
}

TEST(SnapshotsAtRate, CannotBeMoreThanThereAre) {
    EXPECT_THROW(snapshots_at_rate(9, 0.01, 101), OptionError);
    EXPECT_EQ(snapshots_at_rate(0, 0.01, 50), Chosen{});
}

}  // namespace
}  // namespace grainfield::pipelines
