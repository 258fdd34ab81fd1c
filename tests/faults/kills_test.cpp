// Case 16 of docs/reliability.md. Each job is killed at random times of its run and resumed until
// it is done. GRAINFIELD_KILLS sets the kills of each (default 4); scripts/soak makes 100.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>

#include "core/support/random.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/fingerprint.h"
#include "tests/support/md_words.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using testing::fingerprint;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::ScratchFolder;
using testing::with;
using testing::Words;

int kills_wanted() {
    const char* given = std::getenv("GRAINFIELD_KILLS");
    return given == nullptr ? 4 : std::atoi(given);
}

/// Kills are evenly distributed over the time from the start of the program to what the whole run
/// took. At least one must find a checkpoint to go on from: where the machine slows down after the
/// whole run was timed, more are tried.
void expect_same_after_kills(const Words& job) {
    const ScratchFolder folder;
    const auto start = std::chrono::steady_clock::now();
    const Outcome whole = testing::run_grainfield(with(job, {"-o", folder / "whole.h5"}));
    const std::chrono::duration<double> needed = std::chrono::steady_clock::now() - start;
    ASSERT_EQ(whole.code, 0) << whole.err;
    const std::string expected = fingerprint(folder / "whole.h5");
    fs::remove(folder / "whole.h5");

    const std::string output = folder / "killed.h5";
    const Words resumed = with(job, {"-o", output, "--resume"});
    RandomStream random(16, "kill times " + job[1]);
    int found_checkpoint = 0;
    const int most = 20 * kills_wanted();
    for (int kill = 0; kill < kills_wanted() || (found_checkpoint == 0 && kill < most); ++kill) {
        if (fs::exists(output + ".checkpoint")) ++found_checkpoint;
        const Process process(program(resumed));
        std::this_thread::sleep_for(needed * random.uniform());
        process.send(SIGKILL);
        process.wait();
        if (!fs::exists(output)) continue;
        EXPECT_EQ(fingerprint(output), expected) << "after kill " << kill;
        for (const auto& entry : fs::directory_iterator(folder.path())) fs::remove(entry);
    }
    const Outcome last = testing::run_grainfield(resumed);
    ASSERT_EQ(last.code, 0) << last.err;
    EXPECT_EQ(fingerprint(output), expected);
    EXPECT_EQ(folder.entries(), 1U) << "nothing is left beside the output";
    EXPECT_GT(found_checkpoint, 0);
}

TEST(Case16, MolecularDynamicsKilledAtRandomTimesEndsInTheSameData) {
    expect_same_after_kills(with(testing::small_md(), {"--snapshot-every", "7", "--periods", "150",
                                                       "--checkpoint-every", "0"}));
}

TEST(Case16, AFieldRunKilledAtRandomTimesEndsInTheSameData) {
    expect_same_after_kills({"simulate", "field", "--nx", "192", "--relax", "20", "--record", "150",
                             "--store", "50", "--checkpoint-every", "0.01"});
}

TEST(Case16, TrackingKilledAtRandomTimesEndsInTheSameData) {
    const ScratchFolder film;
    Words job{"track", "--fps", "25", "--checkpoint-every", "0"};
    for (const std::string& frame : testing::write_disc_sequence(film, 30)) job.push_back(frame);
    expect_same_after_kills(job);
}

// A run killed before its first checkpoint left nothing to go on from: it starts anew.
TEST(Case16, ARunKilledBeforeItsFirstCheckpointStartsAnew) {
    const ScratchFolder folder;
    const auto run_of = [&](const char* periods) {
        return with(testing::small_md(), {"--periods", periods, "-o", folder / "a.h5", "--resume"});
    };
    const Process process(program(run_of("100000")));  // minutes: it cannot end before the kill
    process.let_work(std::chrono::milliseconds(100), SIGINT);
    process.send(SIGKILL);
    process.wait();
    ASSERT_FALSE(fs::exists(folder / "a.h5"));
    EXPECT_FALSE(fs::exists(folder / "a.h5.checkpoint"));
    const Outcome again = testing::run_grainfield(run_of("20"));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace grainfield
