#include "io/text/curve_csv.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Curve read(const std::string& text) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "sk.csv", std::ios::binary) << text;
    return read_curve_csv(folder / "sk.csv");
}

TEST(CurveCsv, HoldsTheColumnsOfItsHeaderAndTheNameOfItsFile) {
    const Curve curve = read("k,s,phase\r\n0.1,2e-3,liquid\r\n0.25,,solid\r\n");
    EXPECT_EQ(curve.name, "sk");
    ASSERT_EQ(curve.columns.size(), 2U);
    EXPECT_THAT(curve.find("k")->values, ElementsAre(0.1, 0.25));
    EXPECT_EQ(curve.find("s")->values[0], 2e-3);
    EXPECT_TRUE(std::isnan(curve.find("s")->values[1])) << "missing";
    EXPECT_THAT(curve.text_columns.at("phase"), ElementsAre("liquid", "solid"));
}

TEST(CurveCsv, WithAHeaderOnlyHasEmptyColumns) {
    EXPECT_TRUE(read("k,s\n").find("s")->values.empty());
}

TEST(CurveCsv, NamesTheLineThatIsShort) {
    EXPECT_THAT([] { read("k,s\n0.1,1\n0.2\n"); },
                ThrowsMessage<InputError>(HasSubstr("sk.csv', line 3: 1 fields; expected 2")));
    EXPECT_THAT([] { read(""); }, ThrowsMessage<InputError>(HasSubstr("empty")));
    EXPECT_THROW(read_curve_csv("/nonexistent/sk.csv"), InputError);
}

}  // namespace
}  // namespace grainfield::io
