#include "analysis/order/order_examples.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::analysis {
namespace {

constexpr float undefined = std::numeric_limits<float>::quiet_NaN();

// Frame `f` of a window: particle with identity 10 + i has |Q4| `order[i]`, a little more in odd
// frames.
PhaseHistory::Sample frame(int f, const std::vector<float>& order) {
    PhaseHistory::Sample sample{f, 0.25 * f, {}, {}};
    for (std::size_t i = 0; i < order.size(); ++i) {
        sample.id.push_back(10 + static_cast<std::int64_t>(i));
        sample.abs_q.push_back(f % 2 == 0 ? order[i] : order[i] + 0.0625F);
    }
    return sample;
}

void add_window(OrderExamples& examples, const std::vector<float>& order, int first, int frames) {
    for (int f = first; f < first + frames; ++f) examples.add(frame(f, order));
    examples.close_window();
}

TEST(OrderExamples, AreTheMediansOfTheirClassesFrameByFrame) {
    OrderExamples examples({});
    add_window(examples, {0.125F, 0.75F, 0.8125F, 0.875F, 0.25F, 0.1875F, 0.5F}, 100, 8);
    EXPECT_FALSE(examples.wants_more());
    ObservableResult result;
    examples.add_to(result);
    const Curve* curve = result.find_curve("q4_examples");
    ASSERT_NE(curve, nullptr);
    ASSERT_EQ(curve->find("q4")->values.size(), 16U);
    for (std::size_t i = 0; i < 16; ++i) {
        const bool solid = i < 8;
        const auto f = static_cast<double>(i % 8);
        EXPECT_EQ(curve->text_columns.at("phase")[i], solid ? "solid" : "liquid");
        EXPECT_EQ(curve->find("id")->values[i], solid ? 12 : 15);
        EXPECT_EQ(curve->find("t")->values[i], 0.25 * f);
        EXPECT_EQ(curve->find("q4")->values[i],
                  (solid ? 0.8125 : 0.1875) + (i % 2 == 0 ? 0 : 0.0625));
    }
}

TEST(OrderExamples, ComeFromTheFirstWindowWithBothPhases) {
    OrderExamples examples({});
    add_window(examples, {0.125F, 0.5F}, 0, 8);
    EXPECT_TRUE(examples.wants_more());
    add_window(examples, {0.1875F, 0.75F}, 8, 8);
    EXPECT_FALSE(examples.wants_more());
    add_window(examples, {0.25F, 0.875F}, 16, 8);
    ObservableResult result;
    examples.add_to(result);
    const Curve* curve = result.find_curve("q4_examples");
    ASSERT_NE(curve, nullptr);
    EXPECT_EQ(curve->find("q4")->values.front(), 0.75);
    EXPECT_EQ(curve->find("q4")->values[8], 0.1875);
}

TEST(OrderExamples, HaveAValueInEveryFrame) {
    OrderExamples examples({});
    for (int f = 0; f < 8; ++f) {
        PhaseHistory::Sample sample = frame(f, {0.125F, 0.25F, 0.3125F});
        if (f == 3) sample.abs_q[1] = undefined;
        if (f == 5) sample.id[0] = 99;
        examples.add(std::move(sample));
    }
    examples.close_window();
    ObservableResult result;
    examples.add_to(result);
    const Curve* curve = result.find_curve("q4_examples");
    ASSERT_NE(curve, nullptr);
    EXPECT_THAT(curve->find("id")->values, testing::Each(12.0));
    EXPECT_THAT(curve->text_columns.at("phase"), testing::Each("liquid"));
}

TEST(OrderExamples, SayWhyThereAreNone) {
    const auto reason = [](const OrderExamples& examples) {
        ObservableResult result;
        examples.add_to(result);
        return result.find_measurement("q4_examples")->reason;
    };
    OrderExamples short_windows({});
    add_window(short_windows, {0.125F, 0.75F}, 0, 7);
    EXPECT_THAT(reason(short_windows), testing::HasSubstr("8 frames"));
    OrderExamples undecided({});
    add_window(undecided, {0.5F, 0.5625F}, 0, 8);
    EXPECT_THAT(reason(undecided), testing::HasSubstr("no particle is solid or liquid"));
}

}  // namespace
}  // namespace grainfield::analysis
