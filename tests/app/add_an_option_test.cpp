// What CONTRIBUTING says of a new option: one field and one row in `describe`. Help, command line,
// TOML file, range check and record follow.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/command_line.h"

namespace grainfield::app {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Pair;

struct SieveOptions {
    double mesh = 2;  ///< [px]
};

OptionTable describe(SieveOptions& options) {
    OptionTable table("sieve");
    table.number("mesh", options.mesh, "px", {1, 9}, "width of a mesh");
    return table;
}

using Configuration = std::vector<std::pair<std::string, std::string>>;

/// What a run of the command has seen.
struct Seen {
    double mesh = 0;
    Configuration configuration;
};

class SieveCommand : public Command {
 public:
    explicit SieveCommand(Seen& seen) : seen_(seen) {}
    std::string name() const override { return "sift"; }
    std::string purpose() const override { return "sort grains"; }
    Inputs inputs() const override { return {{}, {}, Count::none}; }
    std::vector<OptionTable> options() override { return {describe(options_)}; }
    Summary run(Session& session) override {
        seen_ = {options_.mesh, session.configuration};
        session.plan.run("sieve", "finer with a smaller sieve.mesh");
        session.plan.warn("sieve.mesh is coarse; option 'force' takes it all the same");
        return session.common.explain ? explanation(session.plan) : Summary{};
    }

 private:
    SieveOptions options_;
    Seen& seen_;
};

class AnOptionAddedToATable : public testing::Test {
 protected:
    struct Outcome {
        int code;
        std::string out, err;
        Seen seen;
    };

    std::filesystem::path file_ = std::filesystem::path(testing::TempDir()) /
                                  ("grainfield-option-" + std::to_string(getpid()) + ".toml");

    void TearDown() override { std::filesystem::remove(file_); }

    static Outcome call(std::vector<const char*> words) {
        words.insert(words.begin(), {"grainfield", "sift"});
        Outcome outcome{};
        std::vector<std::unique_ptr<Command>> commands;
        commands.push_back(std::make_unique<SieveCommand>(outcome.seen));
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        outcome.code =
            run_command_line(static_cast<int>(words.size()), words.data(), std::move(commands));
        outcome.out = testing::internal::GetCapturedStdout();
        outcome.err = testing::internal::GetCapturedStderr();
        return outcome;
    }

    Outcome call_with_file(const std::string& text, std::vector<const char*> words = {}) {
        std::ofstream(file_) << text;
        const std::string path = file_.string();
        words.insert(words.begin(), {"-c", path.c_str()});
        return call(std::move(words));
    }
};

TEST_F(AnOptionAddedToATable, AppearsInTheHelpWithUnitRangeAndDefault) {
    EXPECT_THAT(call({"--help-all"}).out,
                AllOf(HasSubstr("[sieve]"), HasSubstr("--mesh"), HasSubstr("width of a mesh"),
                      HasSubstr("[px] 1 … 9"), HasSubstr("default 2")));
}

TEST_F(AnOptionAddedToATable, IsSetByTheCommandLineAndTheFileAndTheCommandLineWins) {
    EXPECT_EQ(call({}).seen.mesh, 2);
    EXPECT_EQ(call({"--mesh", "3"}).seen.mesh, 3);
    EXPECT_EQ(call_with_file("[sieve]\nmesh = 4\n").seen.mesh, 4);
    EXPECT_EQ(call_with_file("[sieve]\nmesh = 4\n", {"--mesh", "5.5"}).seen.mesh, 5.5);
}

TEST_F(AnOptionAddedToATable, IsRefusedOutsideItsRangeFromEitherPlace) {
    const Outcome words = call({"--mesh", "10"});
    EXPECT_EQ(words.code, 2);
    EXPECT_THAT(words.err, AllOf(HasSubstr("mesh"), HasSubstr("10"), HasSubstr("1 … 9")));
    const Outcome file = call_with_file("[sieve]\nmesh = 0.5\n");
    EXPECT_EQ(file.code, 2);
    EXPECT_THAT(file.err, AllOf(HasSubstr(file_.filename().string()), HasSubstr("mesh")));
    EXPECT_EQ(file.seen.mesh, 0) << "the command ran";
}

TEST_F(AnOptionAddedToATable, StandsInTheRecordOfTheRunGivenOrNot) {
    EXPECT_THAT(call({}).seen.configuration, Contains(Pair("sieve.mesh", "2")));
    EXPECT_THAT(call({"--mesh", "3"}).seen.configuration, Contains(Pair("sieve.mesh", "3")));
}

TEST_F(AnOptionAddedToATable, IsNamedByItsFlagWhereverAMessageOfALibraryGoes) {
    const char* warning = "--mesh is coarse; --force takes it all the same";
    EXPECT_EQ(call({}).err, std::string("warning: ") + warning + "\n");
    EXPECT_THAT(call({"--json"}).out, HasSubstr(warning));
    EXPECT_THAT(call({"--explain"}).out, HasSubstr("finer with a smaller --mesh"));
    EXPECT_THAT(call({"--explain", "--json"}).out, HasSubstr("finer with a smaller --mesh"));
}

TEST_F(AnOptionAddedToATable, IsSuggestedWhenMisspelt) {
    const Outcome outcome = call({"--mash", "3"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("did you mean '--mesh'?"));
}

}  // namespace
}  // namespace grainfield::app
