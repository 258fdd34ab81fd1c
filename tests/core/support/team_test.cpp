#include "core/support/team.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/parallel.h"

namespace grainfield {
namespace {

TEST(OnTeam, EveryIndexIsDoneOnceInEveryRound) {
    for (const int threads : {1, 2, 3, 8}) {
        on_team(threads, [&](Team& team) {
            EXPECT_EQ(team.threads(), threads);
            for (int round = 0; round < 200; ++round) {
                std::vector<int> done(static_cast<std::size_t>(round % 13), 0);
                const auto count = static_cast<std::int64_t>(done.size());
                team.split(count, [&](std::int64_t first, std::int64_t last) {
                    for (std::int64_t i = first; i < last; ++i) ++done[static_cast<std::size_t>(i)];
                });
                team.for_each(count, [&](std::int64_t i) { ++done[static_cast<std::size_t>(i)]; });
                for (const int times : done) ASSERT_EQ(times, 2);
            }
        });
    }
}

TEST(OnTeam, RethrowsTheFirstFailureAndGoesOnWorking) {
    for (const int threads : {1, 2, 5}) {
        const auto fail = [](std::int64_t i) {
            if (i % 4 == 3) throw std::runtime_error(std::to_string(i));
        };
        const auto failure_of = [&](const std::function<void()>& work) {
            try {
                work();
            } catch (const std::runtime_error& error) {
                return std::string(error.what());
            }
            return std::string("nothing");
        };
        on_team(threads, [&](Team& team) {
            EXPECT_EQ(failure_of([&] { team.for_each(40, fail); }), "3");
            EXPECT_EQ(failure_of([&] {
                          team.split(40, [&](std::int64_t first, std::int64_t last) {
                              for (std::int64_t i = first; i < last; ++i) fail(i);
                          });
                      }),
                      "3");
            std::atomic<int> sum = 0;
            team.for_each(10, [&](std::int64_t i) { sum += static_cast<int>(i); });
            EXPECT_EQ(sum, 45);
        });
        EXPECT_EQ(failure_of([&] { on_team(threads, [&](Team&) { fail(7); }); }), "7");
    }
}

TEST(OnTeam, MayBeUsedInsideParallelFor) {
    std::vector<std::int64_t> sums(4, 0);
    parallel_for(4, 2, [&](std::int64_t i) {
        on_team(3, [&](Team& team) {
            std::atomic<std::int64_t> sum = 0;
            team.for_each(100, [&](std::int64_t k) { sum += k; });
            sums[static_cast<std::size_t>(i)] = sum;
        });
    });
    for (const std::int64_t sum : sums) EXPECT_EQ(sum, 4950);
}

// A whole run holds one team: what it calls must not start threads of its own.
TEST(OnTeam, LendsItsThreadsToWhatItsBodyCalls) {
    std::set<std::thread::id> own;
    std::set<std::thread::id> seen;
    std::mutex mutex;
    const auto note = [&](std::set<std::thread::id>& ids) {
        const std::lock_guard lock(mutex);
        ids.insert(std::this_thread::get_id());
    };
    on_team(3, [&](Team& team) {
        team.split(team.threads(), [&](std::int64_t, std::int64_t) { note(own); });
        for (int round = 0; round < 20; ++round) {
            parallel_for(50, 3, [&](std::int64_t) { note(seen); });
            on_team(2, [&](Team& inner) {
                EXPECT_EQ(inner.threads(), 2);
                inner.for_each(50, [&](std::int64_t) { note(seen); });
            });
        }
    });
    EXPECT_EQ(own.size(), 3U);
    for (const std::thread::id id : seen) EXPECT_TRUE(own.contains(id));
}

}  // namespace
}  // namespace grainfield
