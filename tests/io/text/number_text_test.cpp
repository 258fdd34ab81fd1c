#include "io/text/number_text.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::io {
namespace {

std::string text_of(double value) {
    std::string text = "<";
    append_number(text, value);
    return text.substr(1);
}

double read_back(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    EXPECT_TRUE(error == std::errc() && end == text.data() + text.size()) << text;
    return value;
}

TEST(NumberText, IsShortAndPlain) {
    EXPECT_EQ(text_of(0.1), "0.1");
    EXPECT_EQ(text_of(-1.0 / 3), "-0.3333333333333333");
    EXPECT_EQ(text_of(100000), "100000");
    EXPECT_EQ(text_of(-9007199254740991.0), "-9007199254740991");
    EXPECT_EQ(text_of(0), "0");
}

TEST(NumberText, OfNothingIsEmpty) {
    EXPECT_EQ(text_of(std::numeric_limits<double>::quiet_NaN()), "");
}

TEST(NumberText, ReadsBackToEveryBit) {
    RandomStream random(3, "number text");
    for (int i = 0; i < 20'000; ++i) {
        const auto bits = std::uint64_t{random.bits()} << 32U | random.bits();
        const auto value = std::bit_cast<double>(bits);
        if (!std::isfinite(value)) continue;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(read_back(text_of(value))), bits);
    }
    for (const double value : {-0.0, 5e-324, 1.7976931348623157e308, 9007199254740992.0, 1e22}) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(read_back(text_of(value))),
                  std::bit_cast<std::uint64_t>(value));
    }
}

TEST(NumberText, QuotesFieldsThatWouldSplitALine) {
    const auto field = [](std::string_view content) {
        std::string text;
        append_field(text, content);
        return text;
    };
    EXPECT_EQ(field("liquid"), "liquid");
    EXPECT_EQ(field("a, b"), "\"a, b\"");
    EXPECT_EQ(field("5\" disc"), "\"5\"\" disc\"");
    EXPECT_EQ(field("two\nlines"), "\"two\nlines\"");
}

}  // namespace
}  // namespace grainfield::io
