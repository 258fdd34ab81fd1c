// Case 24 of docs/reliability.md: what a run makes does not depend on the number of threads.
// Its record does (seconds, threads), which a fingerprint leaves out.
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/fingerprint.h"
#include "tests/support/md_words.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using testing::fingerprint;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::ScratchFolder;
using testing::with;
using testing::Words;

class SameData : public ::testing::Test {
 protected:
    std::string made_with(const std::string& threads, const Words& job, const std::string& name) {
        const std::string output = folder_ / (name + threads + ".h5");
        const Outcome outcome =
            testing::run_grainfield(with(job, {"--threads", threads, "-o", output}));
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return output;
    }

    // One, two and eight threads.
    void expect_same(const Words& job, const std::string& name) {
        const std::string one = fingerprint(made_with("1", job, name));
        EXPECT_EQ(one.size(), 16U);
        for (const char* threads : {"2", "8"}) {
            EXPECT_EQ(fingerprint(made_with(threads, job, name)), one) << threads;
        }
    }

    ScratchFolder folder_;
};

using Case24 = SameData;

TEST_F(Case24, MolecularDynamicsGivesTheSameDataWithOneTwoAndEightThreads) {
    expect_same({"simulate", "md", "--grains", "1300", "--length-x", "9", "--length-y", "160",
                 "--periods", "6", "--snapshot-every", "2", "--order"},
                "md");
}

TEST_F(Case24, AFieldRunGivesTheSameDataWithOneTwoAndEightThreads) {
    expect_same(
        {"simulate", "field", "--nx", "192", "--relax", "5", "--record", "20", "--store", "10"},
        "field");
}

TEST_F(Case24, TrackingAndItsAnalysisGiveTheSameDataWithOneTwoAndEightThreads) {
    const ScratchFolder film;
    Words job{"track", "--fps", "25"};
    for (const std::string& frame : testing::write_disc_sequence(film, 4)) job.push_back(frame);
    expect_same(job, "tracks");
    expect_same({"analyze", folder_ / "tracks1.h5", "--observables", "q4,sk,variance,msd"},
                "results");
}

TEST_F(SameData, OfAnotherSeedHaveAnotherFingerprint) {
    const Words job = with(testing::md_words("40", "8"), {"--periods", "2"});
    const std::string one = made_with("1", with(job, {"--seed", "1"}), "a");
    const std::string other = made_with("1", with(job, {"--seed", "2"}), "b");
    EXPECT_NE(fingerprint(one), fingerprint(other));
}

TEST_F(SameData, OfAFileThatWasChangedAreRefused) {
    const Words job = with(testing::md_words("40", "8"), {"--periods", "2"});
    const std::string file = made_with("1", job, "a");
    const std::string good = testing::read_all(file);
    // The stored digest itself, as text: any other digit is a lie.
    const std::string digest = fingerprint(file);
    const auto at = good.find(digest);
    ASSERT_NE(at, std::string::npos) << "stored in the file";
    std::string bad = good;
    bad[at] = bad[at] == '0' ? '1' : '0';
    std::ofstream(file, std::ios::binary) << bad;
    const Outcome outcome = testing::run_grainfield({"info", file, "--fingerprint"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("a1.h5"));
}

}  // namespace
}  // namespace grainfield
