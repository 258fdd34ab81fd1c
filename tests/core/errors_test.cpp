#include "core/errors.h"

#include <csignal>

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(ErrorText, JoinsProblemActualExpectedAndSuggestion) {
    const ErrorText text{"frame 7 of 'x.avi' has another size", "width 640", "1600, as in frame 0",
                         "remove the file"};
    EXPECT_EQ(text.message(),
              "frame 7 of 'x.avi' has another size: width 640; expected 1600, as in frame 0; "
              "remove the file.");
}

TEST(ErrorText, LeavesOutEmptyParts) {
    EXPECT_EQ((ErrorText{"cannot read 'x.tif'", "", "", ""}.message()), "cannot read 'x.tif'.");
    EXPECT_EQ((ErrorText{"bad", "", "a number", ""}.message()), "bad; expected a number.");
    EXPECT_EQ((ErrorText{"ends already.", "", "", ""}.message()), "ends already.");
    EXPECT_EQ(ErrorText{}.message(), "");
}

TEST(Errors, SubclassesAreCaughtAsErrorWithTheirMessage) {
    try {
        throw InputError(ErrorText{"cannot read 'x.tif'", "", "", ""});
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "cannot read 'x.tif'.");
    }
    EXPECT_EQ(Interrupted(SIGTERM, "stopped").signal(), SIGTERM);
}

}  // namespace
}  // namespace grainfield
