#include "app/completion.h"

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "tests/support/program.h"

namespace grainfield::app {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using testing::Outcome;
using testing::Process;
using testing::ScratchFolder;

class Completion : public ::testing::Test {
 protected:
    void SetUp() override {
        const std::string folder = folder_.path().string();
        const std::vector<const char*> words{"grainfield", "--write-manual", folder.c_str()};
        ASSERT_EQ(run_command_line(static_cast<int>(words.size()), words.data()), 0);
    }

    /// What bash offers for the last of the words, split as bash does.
    std::set<std::string> bash(const std::string& words) const {
        const std::string script = fmt::format(
            "source '{}'; COMP_WORDS=(grainfield {}); COMP_CWORD=$((${{#COMP_WORDS[@]}}-1)); "
            "compopt() {{ :; }}; _grainfield; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
            folder_ / "grainfield", words);
        const Outcome outcome = Process({"bash", "--norc", "-c", script}).wait();
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        std::istringstream lines(outcome.out);
        std::set<std::string> offers;
        for (std::string line; std::getline(lines, line);) {
            if (!line.empty()) offers.insert(line);
        }
        return offers;
    }

    ScratchFolder folder_;
};

TEST_F(Completion, OfBashOffersCommandsAndTheirOptions) {
    EXPECT_EQ(Process({"bash", "-n", folder_ / "grainfield"}).wait().code, 0);
    EXPECT_THAT(bash("tr"), ElementsAre("track"));
    EXPECT_THAT(bash("simulate ''"), ElementsAre("field", "md"));
    EXPECT_THAT(bash("simulate md --per"), ElementsAre("--periods"));
    EXPECT_THAT(bash("track film.avi --no"), ElementsAre("--no-correct-bias", "--no-link"));
}

TEST_F(Completion, OfBashOffersEveryOptionOfTheTables) {
    for (const auto& command : make_commands()) {
        const OptionSet options(command->name(), command->options());
        std::vector<std::string> wanted{"-c", "--config", "--help-all"};
        for (const std::string& flag : options.flags()) wanted.push_back("--" + flag);
        EXPECT_THAT(bash(command->name() + " -"), IsSupersetOf(wanted)) << command->name();
    }
}

TEST_F(Completion, OfBashOffersTheValuesOfAChoiceAndNothingForANumber) {
    EXPECT_THAT(bash("track --polarity ''"), ElementsAre("auto", "bright", "dark"));
    EXPECT_THAT(bash("track --polarity d"), ElementsAre("dark"));
    EXPECT_THAT(bash("track --polarity = d"), ElementsAre("dark")) << "as bash splits --name=value";
    EXPECT_THAT(bash("track --polarity ="), Contains("auto"));
    EXPECT_THAT(bash("track --fps ''"), IsEmpty());
    EXPECT_THAT(bash("track --polarity dark --pol"), Contains("--polarity"));
    EXPECT_THAT(bash("analyze --polar"), Not(Contains("--polarity")));
}

TEST_F(Completion, OfZshIsAcceptedByIt) {
    if (Process({"which", "zsh"}).wait().code != 0) GTEST_SKIP() << "no zsh";
    const Outcome outcome = Process({"zsh", "-n", folder_ / "_grainfield"}).wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
}

TEST_F(Completion, OfFishOffersTheValuesOfAChoice) {
    if (Process({"which", "fish"}).wait().code != 0) GTEST_SKIP() << "no fish";
    const Outcome outcome =
        Process({"fish", "--no-config", "-c",
                 fmt::format("source '{}'; complete -C 'grainfield track --polarity d'",
                             folder_ / "grainfield.fish")})
            .wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out.substr(0, outcome.out.find('\t')), "dark");
}

}  // namespace
}  // namespace grainfield::app
