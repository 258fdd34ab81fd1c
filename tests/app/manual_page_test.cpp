#include "app/manual_page.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "tests/support/program.h"

namespace grainfield::app {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::Process;
using testing::ScratchFolder;

class ManualPage : public ::testing::Test {
 protected:
    void SetUp() override {
        const std::string folder = folder_.path().string();
        const std::vector<const char*> words{"grainfield", "--write-manual", folder.c_str()};
        ASSERT_EQ(run_command_line(static_cast<int>(words.size()), words.data()), 0);
    }

    ScratchFolder folder_;
};

TEST_F(ManualPage, OfEveryCommandIsWrittenUnderTheNameThatManLooksFor) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "grainfield.1"));
    const std::string program = testing::read_all(folder_ / "grainfield.1");
    for (const auto& command : make_commands()) {
        const std::string name = manual_name(command->name());
        EXPECT_TRUE(std::filesystem::exists(folder_ / (name + ".1"))) << name;
        EXPECT_THAT(program, HasSubstr(command->purpose().substr(0, 8)));
    }
    EXPECT_TRUE(std::filesystem::exists(folder_ / "grainfield-simulate-md.1"));
}

TEST_F(ManualPage, HasEveryOptionOfTheTablesAndNothingThatRoffTakesForItsOwn) {
    for (const auto& command : make_commands()) {
        const std::string page = folder_ / (manual_name(command->name()) + ".1");
        const Outcome shown = Process({"groff", "-K", "utf8", "-t", "-ww", "-man", "-Tutf8",
                                       "-rLL=400n", "-P-cbou", page})
                                  .wait();
        ASSERT_EQ(shown.code, 0) << shown.err;
        EXPECT_EQ(shown.err, "") << page;
        const OptionSet options(command->name(), command->options());
        for (const OptionSet::Entry& entry : options.entries()) {
            EXPECT_THAT(shown.out, HasSubstr("--" + entry.flag)) << page;
            EXPECT_THAT(shown.out, HasSubstr(entry.option.domain_text())) << page;
        }
    }
}

TEST(ManualPageOnStandardOutput, IsThatOfTheCommandNamedAndRefusesOthers) {
    const auto call = [](std::vector<const char*> words, std::string& out) {
        words.insert(words.begin(), "grainfield");
        ::testing::internal::CaptureStdout();
        ::testing::internal::CaptureStderr();
        const int code = run_command_line(static_cast<int>(words.size()), words.data());
        out = ::testing::internal::GetCapturedStdout();
        out += ::testing::internal::GetCapturedStderr();
        return code;
    };
    std::string text;
    EXPECT_EQ(call({"--man", "simulate", "md"}, text), 0);
    EXPECT_THAT(text, HasSubstr(".TH GRAINFIELD\\-SIMULATE\\-MD 1"));
    EXPECT_EQ(call({"--man"}, text), 0);
    EXPECT_THAT(text, HasSubstr(".TH GRAINFIELD 1"));
    EXPECT_EQ(call({"--man", "trakc"}, text), 2);
    EXPECT_THAT(text, HasSubstr("trakc"));
    EXPECT_EQ(call({"--completion", "csh"}, text), 2);
    EXPECT_THAT(text, HasSubstr("bash, zsh, fish"));
}

}  // namespace
}  // namespace grainfield::app
