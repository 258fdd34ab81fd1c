#include "simulate/field/worker_team.h"

#include <vector>

#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

TEST(WorkerTeam, EveryIndexIsDoneOnceInEveryRound) {
    for (const int threads : {1, 2, 3, 8}) {
        WorkerTeam team(threads);
        EXPECT_EQ(team.threads(), threads);
        for (int round = 0; round < 2000; ++round) {
            std::vector<int> done(static_cast<std::size_t>(round % 13), 0);
            team.split(static_cast<std::int64_t>(done.size()),
                       [&](std::int64_t first, std::int64_t last) {
                           for (std::int64_t i = first; i < last; ++i)
                               ++done[static_cast<std::size_t>(i)];
                       });
            for (const int times : done) ASSERT_EQ(times, 1);
        }
    }
}

}  // namespace
}  // namespace grainfield::simulate
