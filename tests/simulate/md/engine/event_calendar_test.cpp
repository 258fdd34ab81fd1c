#include "simulate/md/engine/event_calendar.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {

namespace {

// A queue that is right by inspection.
using Oracle = std::map<std::pair<double, std::int32_t>, std::int32_t>;

}  // namespace

// Hold model: the earliest grain gets a new time, and so does another one at random.
TEST(EventCalendar, DeliversGrainsInOrderOfTheirPresentTimes) {
    for (const double expected : {10.0, 1e4, 1e6}) {
        RandomStream random(1, "calendar");
        constexpr std::int32_t grains = 500;
        EventCalendar calendar;
        calendar.reset(0, 20, expected);
        std::vector<double> time(grains);
        Oracle oracle;
        const auto plan = [&](std::int32_t i, double t) {
            oracle.erase({time[static_cast<std::size_t>(i)], i});
            time[static_cast<std::size_t>(i)] = t;
            if (t >= 20) return;
            oracle[{t, i}] = i;
            calendar.push({t, i, i});
        };
        for (std::int32_t i = 0; i < grains; ++i) plan(i, random.uniform(0, 2));
        const auto time_of = [&](std::int32_t i) { return time[static_cast<std::size_t>(i)]; };
        std::int64_t delivered = 0;
        while (const auto* front = calendar.front(time_of, [](std::int32_t) {})) {
            const EventCalendar::Entry entry = *front;
            calendar.pop();
            if (time_of(entry.grain) != entry.time) continue;
            ASSERT_FALSE(oracle.empty());
            ASSERT_EQ(entry.time, oracle.begin()->first.first);
            ASSERT_EQ(entry.grain, oracle.begin()->second);
            const double now = entry.time;
            plan(entry.grain, now + 0.1 * random.uniform());
            const auto other = static_cast<std::int32_t>(random.below(grains));
            if (time_of(other) > now) plan(other, now + 0.3 * random.uniform());
            ++delivered;
        }
        EXPECT_TRUE(oracle.empty());
        EXPECT_GT(delivered, 50000);
    }
}

// As a core of the layer does: it stops between steps, where grains come back that it had lost.
TEST(EventCalendar, StopsBeforeATimeAndTakesEarlierEntriesAfterwards) {
    EventCalendar calendar;
    calendar.reset(0, 100, 2000);
    std::vector<double> time{95, 40, 40, 10.5};
    const auto time_of = [&](std::int32_t i) { return time[static_cast<std::size_t>(i)]; };
    std::int32_t highest = -1;
    const auto look_ahead = [&](std::int32_t bucket) { highest = std::max(highest, bucket); };
    const auto next = [&](double until) { return calendar.front(time_of, look_ahead, until); };
    calendar.push({95, 0, 0});
    calendar.push({40, 1, 1});
    time[1] = 60;  // nothing valid is left before 95
    EXPECT_EQ(next(10), nullptr);
    EXPECT_EQ(highest, 10) << "one bucket a unit of time: that of `until` and no farther";
    calendar.push({10.5, 3, 3});
    calendar.push({40, 2, 2});
    for (const std::int32_t due : {3, 2}) {
        const EventCalendar::Entry* entry = next(50);
        ASSERT_NE(entry, nullptr);
        EXPECT_EQ(entry->grain, due);
        calendar.pop();
    }
    EXPECT_EQ(next(50), nullptr);
    calendar.push({60, 1, 1});
    EXPECT_EQ(next(100)->grain, 1);
    calendar.pop();
    EXPECT_EQ(next(100)->grain, 0);
    calendar.pop();
    EXPECT_EQ(next(100), nullptr);
}

TEST(EventCalendar, EqualTimesComeInOrderOfIdentity) {
    EventCalendar calendar;
    calendar.reset(0, 1, 10);
    for (const std::int32_t id : {7, 3, 5}) calendar.push({0.5, id, 10 - id});
    const auto time_of = [](std::int32_t) { return 0.5; };
    for (const std::int32_t id : {3, 5, 7}) {
        EXPECT_EQ(calendar.front(time_of, [](std::int32_t) {})->id, id);
        calendar.pop();
    }
    EXPECT_EQ(calendar.front(time_of, [](std::int32_t) {}), nullptr);
}

}  // namespace grainfield::simulate
