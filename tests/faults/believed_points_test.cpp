// Points that no experiment gives are refused with file, frame and particle; what may be meant is
// said.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;

class BelievedPoints : public ::testing::Test {
 protected:
    Outcome analyze(const std::string& rows, const std::vector<std::string>& more) const {
        std::ofstream(folder_ / "points.csv") << "frame,particle,x,y\n" << rows;
        return testing::run_grainfield(
            testing::with({"analyze", folder_ / "points.csv", "-o", folder_ / "r.h5", "--force",
                           "--observables", "q4", "--diameter", "1"},
                          more));
    }

    testing::ScratchFolder folder_;
};

TEST_F(BelievedPoints, FarBesideTheirBoxAreRefusedWithTheirLine) {
    const Outcome outcome = analyze("0,0,88,12\n0,1,130.5,150\n", {"--box", "1,1"});
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("points.csv', line 2"), HasSubstr("particle 0"),
                                   HasSubstr("(88, 12), beside a box of 1 × 1")));
    EXPECT_EQ(analyze("0,0,1,1\n0,1,1e300,2\n", {"--box", "10,10"}).code, 3);
}

TEST_F(BelievedPoints, BesideTheirBoxAreSaid) {
    const Outcome outcome =
        analyze("0,0,88,12\n0,1,130.5,50\n0,2,30,40\n0,3,160,5\n", {"--box", "100,100"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err,
                HasSubstr("warning: 2 of 4 points lie outside the box [0, 100] × [0, 100]; is it "
                          "the right one (--box)?"));
}

TEST_F(BelievedPoints, WithTimesThatStandStillOrGoBackAreRefused) {
    for (const char* second : {"1.5", "1.25"}) {
        const Outcome outcome = analyze(
            std::string("# grainfield points 1\n# frame 0 time 1.5\n0,0,1,1\n# frame 1 time ") +
                second + "\n1,0,1,1\n",
            {"--box", "10,10"});
        EXPECT_EQ(outcome.code, 3) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(HasSubstr("points.csv"), HasSubstr("frame 1 is at")));
    }
}

}  // namespace
}  // namespace grainfield
