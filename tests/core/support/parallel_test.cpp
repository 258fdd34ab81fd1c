#include "core/support/parallel.h"

#include <atomic>
#include <barrier>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace grainfield {
namespace {

std::vector<double> square_roots(int threads) {
    std::vector<double> result(1000);
    parallel_for(1000, threads, [&](std::int64_t i) {
        result[static_cast<std::size_t>(i)] = std::sqrt(static_cast<double>(i));
    });
    return result;
}

TEST(ParallelFor, GivesTheSameResultForOneTwoAndEightThreads) {
    const auto serial = square_roots(1);
    EXPECT_EQ(serial[81], 9);
    EXPECT_EQ(square_roots(2), serial);
    EXPECT_EQ(square_roots(8), serial);
    EXPECT_EQ(square_roots(0), serial);
}

TEST(ParallelFor, VisitsEveryIndexExactlyOnce) {
    std::vector<std::atomic<int>> visits(5000);
    parallel_for(5000, 8, [&](std::int64_t i) { ++visits[static_cast<std::size_t>(i)]; });
    for (const auto& count : visits) EXPECT_EQ(count.load(), 1);
}

TEST(ParallelFor, RethrowsTheFailureOfTheSmallestIndexWhateverTheTiming) {
    for (int attempt = 0; attempt < 50; ++attempt) {
        for (const int threads : {1, 2, 8}) {
            try {
                parallel_for(200, threads, [](std::int64_t i) {
                    if (i % 40 == 39) throw std::runtime_error(std::to_string(i));
                });
                FAIL() << "nothing was thrown with " << threads << " threads";
            } catch (const std::runtime_error& error) {
                EXPECT_STREQ(error.what(), "39");
            }
        }
    }
}

TEST(ParallelFor, DoesNothingForAnEmptyRange) {
    parallel_for(0, 4, [](std::int64_t) { FAIL(); });
    parallel_for(-3, 4, [](std::int64_t) { FAIL(); });
}

TEST(ParallelFor, KeepsItsContractInsideItselfAndOnSeveralThreads) {
    constexpr std::int64_t outer = 6;
    constexpr std::int64_t inner = 500;
    std::vector<std::atomic<int>> visits(2 * outer * inner);
    const auto nested = [&](std::int64_t caller) {
        parallel_for(outer, 2, [&, caller](std::int64_t i) {
            parallel_for(inner, 3, [&](std::int64_t j) {
                ++visits[static_cast<std::size_t>((caller * outer + i) * inner + j)];
            });
        });
    };
    {
        const std::jthread other([&] { nested(1); });
        nested(0);
    }
    for (const auto& count : visits) EXPECT_EQ(count.load(), 1);
    EXPECT_THROW(parallel_for(outer, 2,
                              [](std::int64_t) {
                                  parallel_for(9, 3, [](std::int64_t j) {
                                      if (j == 4) throw std::runtime_error("inner");
                                  });
                              }),
                 std::runtime_error);
}

TEST(ParallelFor, UsesSeveralThreadsInsideItself) {
    std::mutex mutex;
    std::set<std::thread::id> seen;
    parallel_for(2, 2, [&](std::int64_t) {
        std::barrier together(2);  // returns only if two threads are there
        parallel_for(2, 2, [&](std::int64_t) {
            together.arrive_and_wait();
            const std::lock_guard lock(mutex);
            seen.insert(std::this_thread::get_id());
        });
    });
    EXPECT_GE(seen.size(), 2U);
}

TEST(ThreadCount, IsTheRequestIfPositiveElseAtLeastOne) {
    EXPECT_EQ(thread_count(5), 5);
    EXPECT_GE(thread_count(0), 1);
    EXPECT_GE(thread_count(-2), 1);
}

}  // namespace
}  // namespace grainfield
