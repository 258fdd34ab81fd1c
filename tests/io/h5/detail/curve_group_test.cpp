#include "io/h5/detail/curve_group.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

std::vector<Curve> through_file(const std::vector<Curve>& curves) {
    const testing::ScratchFolder folder;
    {
        H5File file = H5File::create(folder / "x.h5", "x.h5");
        write_curves(H5Group::root(file).make_group("curves"), curves);
        file.close();
    }
    const H5File file = H5File::open(folder / "x.h5");
    return read_curves(H5Group::root(file).group("curves"));
}

Curve sizes() {
    return {"sizes",
            "Sizes",
            {{"d", "px", "Diameter", {14, 15}}, {"w", "px", "Edge width", {1.5, 1.25}}},
            {{"phase", {"liquid", "a, \"b\""}}}};
}

TEST(CurveGroup, GivesBackNumbersAndWords) {
    Curve plain = sizes();
    plain.name = "plain";
    plain.text_columns.clear();
    const std::vector<Curve> read = through_file({sizes(), plain});
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].title, "Sizes");
    ASSERT_EQ(read[0].columns.size(), 2U);
    EXPECT_EQ(read[0].columns[1].unit, Unit("px"));
    EXPECT_EQ(read[0].columns[1].values, (std::vector<double>{1.5, 1.25}));
    EXPECT_EQ(read[0].text_columns, sizes().text_columns);
    EXPECT_EQ(read[1].name, "plain");
    EXPECT_THAT(read[1].text_columns, IsEmpty());
}

TEST(CurveGroup, OfColumnsWithDifferentLengthsIsRefused) {
    Curve numbers = sizes();
    numbers.columns[1].values.pop_back();
    Curve words = sizes();
    words.text_columns["phase"].pop_back();
    for (const Curve& uneven : {numbers, words}) {
        EXPECT_THAT([&] { through_file({uneven}); },
                    ThrowsMessage<InputError>(HasSubstr("different lengths")));
    }
}

}  // namespace
}  // namespace grainfield::io
