#include "core/support/parallel.h"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
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

TEST(ThreadCount, IsTheRequestIfPositiveElseAtLeastOne) {
    EXPECT_EQ(thread_count(5), 5);
    EXPECT_GE(thread_count(0), 1);
    EXPECT_GE(thread_count(-2), 1);
}

}  // namespace
}  // namespace grainfield
