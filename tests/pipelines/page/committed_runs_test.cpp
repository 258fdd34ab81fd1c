#include "pipelines/page/committed_runs.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class CommittedRuns : public ::testing::Test {
 protected:
    CommittedRuns() {
        for (const char* gamma : {"gamma-4.50", "gamma-4.00"}) {
            fs::create_directory(folder_ / gamma);
            std::ofstream(folder_ / gamma + "/sk.csv") << "k,s,s_err,n\n0.1,0.2,0.01,4\n";
            std::ofstream(folder_ / gamma + "/variance.csv") << "l,variance,err,mean\n1,2,,3\n";
        }
        std::ofstream(folder_ / "fits.csv") << "gamma,s0,s0_err,s1,s1_err\n4.00,0.1,0.01,1.5,0.2\n";
        write_range({"md", "md", "md"});
    }
    void write_range(const std::array<const char*, 3>& origins) {
        std::ofstream(folder_ / "range.csv")
            << "gamma,origin,modes,s0_over_s1,err,low,high\n4.00," << origins[0]
            << ",box,0.2,0.1,0.1,0.3\n4.00," << origins[1] << ",plane-waves,0.7,0.1,0.1,0.3\n4.50,"
            << origins[2] << ",box,0.1,0.1,0.1,0.3\n";
    }
    testing::ScratchFolder folder_;
};

TEST_F(CommittedRuns, AreThoseOfTheFoldersByGrowingGamma) {
    const std::vector<Results> runs = committed_runs(folder_.path());
    ASSERT_EQ(runs.size(), 3U) << "two runs and their S0/S1";
    EXPECT_EQ(runs[0].label, "committed MD, Γ = 4");
    EXPECT_EQ(runs[0].identity.control->value, 4);
    EXPECT_EQ(runs[1].identity.control->value, 4.5);
    EXPECT_EQ(runs[0].find("sk")->find_curve("sk")->find("k")->unit, Unit("1/a"));
    EXPECT_EQ(runs[0].find("fit")->find_measurement("s1")->value, 1.5);
    EXPECT_EQ(runs[1].find("fit"), nullptr) << "no S1 at 4.5 in the table";
}

TEST_F(CommittedRuns, HaveTheRatiosOfTheModesBetweenWalls) {
    const Results ratios = committed_runs(folder_.path()).back();
    EXPECT_EQ(ratios.identity.role, RunRole::critical_point);
    const Curve* curve = ratios.find("critical")->find_curve("critical");
    EXPECT_THAT(curve->find("x")->values, ElementsAre(4, 4.5));
    EXPECT_THAT(curve->find("s0_over_s1")->values, ElementsAre(0.2, 0.1));
    EXPECT_EQ(curve->find("x")->meaning, "Γ");
}

TEST_F(CommittedRuns, AreOfTheOriginThatTheTableSays) {
    for (const auto& [word, origin, label] :
         {std::tuple("md", Origin::md, "committed MD"),
          {"video", Origin::video, "committed tracked"},
          {"rendered", Origin::rendered, "committed true positions"}}) {
        write_range({word, word, word});
        const std::vector<Results> runs = committed_runs(folder_.path());
        for (const Results& run : runs) EXPECT_EQ(run.identity.origin, origin) << word;
        EXPECT_EQ(runs.front().source.origin, origin);
        EXPECT_EQ(runs.front().label, std::string(label) + ", Γ = 4");
        EXPECT_EQ(runs.back().label, label);
    }
}

TEST_F(CommittedRuns, OfAnOriginThatIsNotKnownAreAnError) {
    write_range({"md", "md", "video"});
    EXPECT_THAT([&] { committed_runs(folder_.path()); },
                ThrowsMessage<InputError>(HasSubstr("origin 'md' and 'video'")));
    write_range({"laboratory", "md", "md"});
    EXPECT_THAT([&] { committed_runs(folder_.path()); },
                ThrowsMessage<InputError>(HasSubstr("origin 'laboratory'")));
    std::ofstream(folder_ / "range.csv") << "gamma,s0_over_s1,err\n4.00,0.2,0.1\n";
    EXPECT_THAT([&] { committed_runs(folder_.path()); },
                ThrowsMessage<InputError>(HasSubstr("no words in a column 'origin'")));
}

TEST(CommittedRunsOfTheProject, AreMolecularDynamics) {
    for (const Results& run : committed_runs(GRAINFIELD_SOURCE_DIR "/bench/results/paper")) {
        EXPECT_EQ(run.identity.origin, Origin::md) << run.label;
    }
}

TEST_F(CommittedRuns, ThatAreNotThereAreAnError) {
    EXPECT_THAT([&] { committed_runs(folder_ / "gamma-4.00"); },
                ThrowsMessage<InputError>(HasSubstr("no committed runs")));
    EXPECT_THROW(committed_runs("/nonexistent"), InputError);
}

}  // namespace
}  // namespace grainfield::pipelines
