#include "app/command_line.h"

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/version.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Outcome {
    int code;
    std::string out, err;
};

Outcome call(std::vector<const char*> words) {
    words.insert(words.begin(), "grainfield");
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = run_command_line(static_cast<int>(words.size()), words.data());
    std::string out = ::testing::internal::GetCapturedStdout();
    return {code, std::move(out), ::testing::internal::GetCapturedStderr()};
}

TEST(CommandLine, VersionAndHelpAreNoErrors) {
    const Outcome version = call({"--version"});
    EXPECT_EQ(version.code, 0);
    EXPECT_EQ(version.out, std::string("grainfield ") + kVersion + "\n");
    const Outcome help = call({"--help"});
    EXPECT_EQ(help.code, 0);
    for (const char* name : {"track", "analyze", "compare", "export", "info"}) {
        EXPECT_THAT(help.out, HasSubstr(name));
    }
}

TEST(CommandLine, HelpOfACommandShowsUnitRangeAndDefaultOfItsOptions) {
    const Outcome help = call({"track", "--help-all"});
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.out,
                AllOf(HasSubstr("--max-sweeps"), HasSubstr("[px]"), HasSubstr("default auto"),
                      HasSubstr("--threads"), HasSubstr("-c, --config"), HasSubstr("-o, --output"),
                      HasSubstr("[refine]")));
    EXPECT_EQ(call({"analyze", "--help"}).code, 0);
    EXPECT_EQ(call({"compare", "--help"}).code, 0);
    EXPECT_EQ(call({"export", "--help"}).code, 0);
    EXPECT_EQ(call({"info", "--help"}).code, 0);
}

TEST(CommandLine, WrongUsageEndsWithTwoAndASuggestionOnStandardError) {
    EXPECT_EQ(call({}).code, 2);
    EXPECT_EQ(call({"track"}).code, 2);
    const Outcome command = call({"trakc", "a.png"});
    EXPECT_EQ(command.code, 2);
    EXPECT_THAT(command.err, HasSubstr("did you mean 'track'?"));
    const Outcome option = call({"track", "a.png", "-o", "b.h5", "--max-sweps", "3"});
    EXPECT_EQ(option.code, 2);
    EXPECT_THAT(option.err, ::testing::EndsWith("did you mean '--max-sweeps'?\n"));
    EXPECT_EQ(option.out, "");
    const Outcome value = call({"track", "a.png", "-o", "b.h5", "--threads", "many"});
    EXPECT_EQ(value.code, 2);
    EXPECT_THAT(value.err, AllOf(HasSubstr("--threads"), HasSubstr("'many'")));
    const Outcome twice = call({"track", "a.png", "-o", "b.h5", "-o", "c.h5"});
    EXPECT_EQ(twice.code, 2);
    EXPECT_EQ(twice.err, "error: --output is given 2 times, expected once; see --help.\n");
    const Outcome none = call({"track", "a.png", "-o"});
    EXPECT_EQ(none.code, 2);
    EXPECT_EQ(none.err, "error: --output has no value; see --help.\n");
}

TEST(CommandLine, AnUnknownOptionIsToldBeforeItsValueIsTakenForAnInput) {
    const Outcome outcome = call({"export", "a.h5", "-o", "-", "--form", "xyz"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("does not know '--form'"), HasSubstr("'--format'?")));
    const Outcome two = call({"export", "a.h5", "b.h5"});
    EXPECT_EQ(two.code, 2);
    EXPECT_THAT(two.err, HasSubstr("'export' takes one input: 2: 'a.h5', 'b.h5'"));
}

TEST(CommandLine, AnOptionThatOtherProgramsHaveIsAnsweredWithWhatServesHere) {
    const Outcome outcome = call({"analyze", "a.h5", "-o", "b.h5", "--skip=100"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("does not know '--skip"),
                                   HasSubstr("give '--frames FIRST:END:STEP'")));
}

TEST(CommandLine, AConfigurationGivenAsAnInputIsToldWhereItBelongs) {
    const grainfield::testing::ScratchFolder folder;
    const std::string file = folder / "md.toml";
    std::ofstream(file) << "[cell]\n";
    const Outcome outcome = call({"simulate", "md", file.c_str()});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("-c " + file));
}

TEST(CommandLine, AnOutputThatLooksLikeAnOptionIsRefused) {
    const Outcome outcome = call({"export", "a.h5", "-o", "-x"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("output '-x' looks like an option"), HasSubstr("-o ./-x")));
    EXPECT_FALSE(std::filesystem::exists("-x"));
}

// It is named after the input.
TEST(CommandLine, AnOutputNeedNotBeNamed) {
    for (const char* command : {"track", "analyze", "compare", "export"}) {
        const Outcome outcome = call({command, "/nonexistent/a.h5"});
        EXPECT_EQ(outcome.code, 3) << command;
        EXPECT_THAT(outcome.err, HasSubstr("cannot read '/nonexistent/a.h5'"));
    }
}

TEST(CommandLine, AnInputThatIsNotThereEndsWithThreeAndItsName) {
    const std::vector<std::vector<const char*>> calls{
        {"track", "/nonexistent/a.png", "-o", "b.h5"},
        {"analyze", "/nonexistent/a.h5", "-o", "b.h5"},
        {"compare", "/nonexistent/a.h5", "-o", "b.html"},
        {"export", "/nonexistent/a.h5", "-o", "b.csv"},
        {"info", "/nonexistent/a.h5"},
        {"info", "/nonexistent/a.png", "-c", "/nonexistent/a.toml"}};
    for (const auto& words : calls) {
        const Outcome outcome = call(words);
        EXPECT_EQ(outcome.code, 3) << words[0];
        EXPECT_THAT(outcome.err, HasSubstr("/nonexistent/a."));
        EXPECT_EQ(outcome.out, "");
    }
}

}  // namespace
}  // namespace grainfield::app
