#include "core/support/progress.h"

#include <cmath>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield {
namespace {

using testing::MatchesRegex;

TEST(Progress, LineTellsCountRateAndTimeLeft) {
    Progress progress("tracking", 3000, "frames", Verbosity::quiet);
    EXPECT_EQ(progress.line(), "tracking 0/3000 frames");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    progress.advance(120);
    EXPECT_THAT(progress.line(),
                MatchesRegex("tracking 120/3000 frames, [0-9.e+]+ frames/s, [0-9.]+ s left"));
    progress.advance(2880);
    EXPECT_THAT(progress.line(), MatchesRegex("tracking 3000/3000 frames, [0-9.e+]+ frames/s"));
}

TEST(Progress, WhatAnEarlierRunHasDoneIsNotInTheRate) {
    Progress progress("simulating", 1000000, "periods", Verbosity::quiet);
    progress.resume_at(998000);
    progress.resume_at(1000);  // it adds up
    EXPECT_EQ(progress.line(), "simulating 999000/1000000 periods");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    progress.advance(10);
    progress.count(500, "events");
    const std::string line = progress.line();
    EXPECT_THAT(line, MatchesRegex("simulating 999010/1000000 periods, [0-9.]+ periods/s, "
                                   "[0-9.e+]+ events/s, .+ left"));
    const double rate = std::stod(line.substr(line.find(", ") + 2));
    EXPECT_LT(rate, 10 / 0.02) << "999,000 periods in 20 ms would be 5e7 a second";
}

TEST(Progress, AnUnknownTotalGivesNoTimeLeft) {
    Progress progress("reading", 0, "rows", Verbosity::quiet);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    progress.advance(3);
    EXPECT_THAT(progress.line(), MatchesRegex("reading 3 rows, [0-9.e+]+ rows/s"));
}

TEST(Progress, PrintsNothingInTheFirstTwoSecondsNorWhenQuiet) {
    testing::internal::CaptureStderr();
    {
        Progress normal("tracking", 10, "frames", Verbosity::normal);
        normal.advance(10);
        Progress quiet("tracking", 10, "frames", Verbosity::quiet);
        quiet.advance(10);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(FormatDuration, UsesTheUnitPeopleWouldUse) {
    EXPECT_EQ(format_duration(4.24), "4.2 s");
    EXPECT_EQ(format_duration(9.96), "10 s");
    EXPECT_EQ(format_duration(59.4), "59 s");
    EXPECT_EQ(format_duration(59.6), "1 min 0 s");
    EXPECT_EQ(format_duration(200), "3 min 20 s");
    EXPECT_EQ(format_duration(3720), "1 h 02 min");
    EXPECT_EQ(format_duration(-1), "unknown time");
    EXPECT_EQ(format_duration(std::numeric_limits<double>::quiet_NaN()), "unknown time");
}

}  // namespace
}  // namespace grainfield
