// Case 15 of docs/reliability.md: options that make no sense.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class BadConfiguration : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    std::string frame_ = testing::write_disc_sequence(folder_, 1)[0];

    Outcome with_file(const std::string& text) {
        const std::string file = folder_ / "run.toml";
        std::ofstream(file) << text;
        return run_grainfield({"track", frame_, "-o", folder_ / "t.h5", "-c", file});
    }

    void expect_nothing_written() {
        EXPECT_FALSE(std::filesystem::exists(folder_ / "t.h5"));
        EXPECT_LE(folder_.entries(), 2U) << "the frame and the configuration";
    }
};

using Case15 = BadConfiguration;

TEST_F(BadConfiguration, APipeIsRefusedAndNotWaitedFor) {
    const std::string pipe = folder_ / "run.toml";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const Outcome outcome = run_grainfield({"track", frame_, "-o", folder_ / "t.h5", "-c", pipe});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.toml"), HasSubstr("pipe")));
    expect_nothing_written();
}

TEST_F(Case15, NanNamesFileAndLine) {
    const Outcome outcome = with_file("[calibrate]\n\ndiameter = nan\n");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.toml"), HasSubstr("line 3"),
                                   HasSubstr("'diameter'"), HasSubstr("[px]")));
    expect_nothing_written();
}

TEST_F(Case15, AnUnknownKeyNamesTheNearestOne) {
    const Outcome outcome = with_file("[calibrate]\ndiametre = 9\n");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.toml"), HasSubstr("line 2"),
                                   HasSubstr("did you mean 'diameter'?")));
    expect_nothing_written();
}

TEST_F(Case15, AnUnknownOptionNamesTheNearestOne) {
    const Outcome outcome =
        run_grainfield({"track", frame_, "-o", folder_ / "t.h5", "--diametre", "9"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("--diametre"), HasSubstr("did you mean '--diameter'?")));
    expect_nothing_written();
}

TEST_F(Case15, AWrongUnitOnTheCommandLineIsRefused) {
    const Outcome outcome =
        run_grainfield({"track", frame_, "-o", folder_ / "t.h5", "--diameter", "9mm"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("'9mm'"), HasSubstr("[px]")));
    expect_nothing_written();
}

TEST_F(Case15, AWrongUnitOrTypeInTheFileNamesFileAndLine) {
    for (const char* value : {"\"9 mm\"", "true", "inf", "-9"}) {
        const Outcome outcome = with_file(std::string("[calibrate]\n\ndiameter = ") + value + "\n");
        EXPECT_EQ(outcome.code, 2) << value;
        EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.toml"), HasSubstr("line 3"),
                                       HasSubstr("'diameter'"), HasSubstr("[px]")))
            << value;
    }
    expect_nothing_written();
}

TEST_F(BadConfiguration, AFrameRangeThatSelectsNothingOrMakesNoSenseIsRefused) {
    for (const char* range : {"5:9", "a:b", "::0", "1:2:3:4"}) {
        const Outcome outcome =
            run_grainfield({"track", frame_, "-o", folder_ / "t.h5", "--frames", range});
        EXPECT_EQ(outcome.code, 2) << range << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(range));
    }
    expect_nothing_written();
}

TEST_F(BadConfiguration, AnOptionOfALiveSourceIsRefusedWithoutOne) {
    for (const testing::Words& option : {testing::Words{"--live-size", "64,64"},
                                         {"--live-depth", "12"},
                                         {"--live-queue", "20"},
                                         {"--live-wait"},
                                         {"--live-silence", "5"},
                                         {"--preview", "now.png"}}) {
        const Outcome outcome =
            run_grainfield(testing::with({"track", frame_, "-o", folder_ / "t.h5"}, option));
        EXPECT_EQ(outcome.code, 2) << option[0];
        EXPECT_THAT(outcome.err, AllOf(HasSubstr(option[0] + " is of a live source"),
                                       HasSubstr("name the source with --live")));
    }
    expect_nothing_written();
}

TEST_F(BadConfiguration, AMissingFileIsABadInput) {
    const Outcome outcome =
        run_grainfield({"track", frame_, "-o", folder_ / "t.h5", "-c", folder_ / "missing.toml"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("missing.toml"));
}

TEST_F(BadConfiguration, AnUnknownObservableOrBoxIsRefused) {
    ASSERT_EQ(run_grainfield({"track", frame_, "-o", folder_ / "t.h5"}).code, 0);
    const Outcome observable = run_grainfield(
        {"analyze", folder_ / "t.h5", "-o", folder_ / "r.h5", "--observables", "q4,skk"});
    EXPECT_EQ(observable.code, 2);
    EXPECT_THAT(observable.err, HasSubstr("skk"));
    const Outcome box =
        run_grainfield({"analyze", folder_ / "t.h5", "-o", folder_ / "r.h5", "--box", "100"});
    EXPECT_EQ(box.code, 2);
    EXPECT_THAT(box.err, AllOf(HasSubstr("--box"), HasSubstr("2 numbers")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "r.h5"));
}

}  // namespace
}  // namespace grainfield
