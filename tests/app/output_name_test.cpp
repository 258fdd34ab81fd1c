#include "app/output_name.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

TEST(OutputName, OfAFolderHasNoExtensionThatBeginsWithALetter) {
    for (const char* folder : {"curves", "e4.35", "run.7", "a/gamma-4.00", "results.csv/", "."}) {
        EXPECT_TRUE(is_folder_name(folder)) << folder;
    }
    for (const char* file : {"a.csv", "e4.35.csv", "a.b/c.tif", "curves.v2"}) {
        EXPECT_FALSE(is_folder_name(file)) << file;
    }
}

TEST(OutputName, OfAFolderThatIsThereMayBeAny) {
    const testing::ScratchFolder folder;
    EXPECT_FALSE(is_folder_name(folder / "a.csv"));
    std::filesystem::create_directory(folder / "a.csv");
    EXPECT_TRUE(is_folder_name(folder / "a.csv"));
}

}  // namespace
}  // namespace grainfield::app
