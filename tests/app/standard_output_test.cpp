#include "app/standard_output.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::app {
namespace {

TEST(StandardOutputFile, GivesItsBytesAndGoesWithAllThatLiesBesideIt) {
    const std::string bytes("a,b\r\n\0\xff", 7);
    std::filesystem::path folder;
    {
        const StandardOutputFile file("table.csv");
        EXPECT_EQ(file.path().filename(), "table.csv");
        folder = file.path().parent_path();
        std::ofstream(file.path(), std::ios::binary) << bytes;
        std::ofstream(folder / "beside.meta") << "x";
        EXPECT_EQ(file.text(), bytes);
    }
    EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(StandardOutputFile, OfTwoHaveFoldersOfTheirOwn) {
    const StandardOutputFile one("a.csv");
    const StandardOutputFile other("a.csv");
    EXPECT_NE(one.path(), other.path());
}

TEST(StandardOutput, TakesNoSummaryBesideTheOutput) {
    Session session;
    EXPECT_NO_THROW(require_no_json_beside(session));
    session.common.json = true;
    EXPECT_THROW(require_no_json_beside(session), OptionError);
}

}  // namespace
}  // namespace grainfield::app
