// Case 26 of docs/reliability.md: what cannot be done is refused before anything is allocated, and
// what can be done takes no more memory for more frames.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/image_files.h"
#include "tests/support/layer_frames.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::ScratchFolder;

// With 4 GB, whatever the machine has.
TEST(Case26, ASizeBeyondTheLimitOnMemoryIsRefusedAtOnceWithWhatItNeedsAndWhatThereIs) {
    if (testing::kIsSanitized) GTEST_SKIP() << "the sanitizer reserves more than any limit";
    for (const std::string call :
         {"field --nx 16777216", "field --nx 4096 --ny 16384 --replicas 20",
          "field --record 1e12 --dt 1e-6",
          "md --grains 100000000 --length-x 12000 --length-y 12000",
          "md --grains 10 --length-x 60000 --length-y 60000", "md --grains 1000 --periods 1e9"}) {
        const ScratchFolder folder;
        const auto start = std::chrono::steady_clock::now();
        const Outcome outcome = testing::shell("ulimit -v 4000000; $GRAINFIELD simulate " + call +
                                               " -o " + (folder / "x.h5"));
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << call;
        EXPECT_EQ(outcome.code, 2) << call << ": " << outcome.err;
        EXPECT_THAT(outcome.err, ::testing::ContainsRegex("about [0-9.e+]+ (GB|MB) of memory and "))
            << call;
        EXPECT_THAT(outcome.err,
                    ::testing::ContainsRegex("at most [0-9.]+ (GB|MB), which are free"))
            << call;
        EXPECT_THAT(outcome.err, HasSubstr("--force-size")) << call;
        EXPECT_EQ(folder.entries(), 0U) << call;
    }
}

/// The largest memory of the programs run so far [MB].
double most_memory() {
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    return static_cast<double>(used.ru_maxrss) / 1024;
}

// 300 frames of 0.64 MB in single precision would take 190 MB.
TEST(Case26, AFilmOfAnyLengthIsTrackedInTheSameMemory) {
    if (testing::kIsSanitized) GTEST_SKIP() << "the sanitizer keeps what is freed for a while";
    const ScratchFolder film, folder;
    const std::string picture = film / "picture.png";
    testing::write_png(picture, testing::tanh_frame(testing::isolated_discs(400, 400, 10, 20, 1), 9,
                                                    1.25, 0.02, 1));
    std::vector<std::string> words{"track", "--threads", "1",  "--quiet",      "--fps",
                                   "1",     "--force",   "-o", folder / "t.h5"};
    std::vector<double> memory;
    for (int i = 0; i < 300; ++i) {
        words.push_back(film / fmt::format("frame_{:03}.png", i));
        std::filesystem::create_symlink(picture, words.back());
        if (i != 5 && i != 299) continue;
        const Outcome outcome = testing::run_grainfield(words);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        memory.push_back(most_memory());
    }
    EXPECT_LT(memory[1] - memory[0], 30) << memory[0] << " MB for six frames";
}

// A reader that runs out of memory must not take the picture for a damaged one, which is left out.
TEST(Case26, AFrameBeyondTheLimitOnMemoryIsNotCalledDamaged) {
    if (testing::kIsSanitized) GTEST_SKIP() << "the sanitizer reserves more than any limit";
    const ScratchFolder folder;
    const std::string frame = folder / "frame.pgm";
    std::ofstream(frame) << "P5\n9000 9000\n255\n";
    std::filesystem::resize_file(frame, std::filesystem::file_size(frame) + 9000 * 9000);
    int refused = 0;
    for (const int megabytes : {400, 450, 500, 550, 600}) {
        const Outcome outcome = testing::shell(
            fmt::format("ulimit -v {}; \"$GRAINFIELD\" track '{}' --threads 1 -o '{}'",
                        1000 * megabytes, frame, folder / "t.h5"));
        EXPECT_THAT(outcome.code, ::testing::AnyOf(1, 3)) << outcome.err;
        EXPECT_THAT(outcome.err,
                    ::testing::AnyOf(HasSubstr("out of memory"), HasSubstr("no spheres to track")));
        EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("damaged")));
        if (outcome.code == 1) ++refused;
    }
    EXPECT_GT(refused, 2);
}

TEST(InsistedOnSize, IsBegunWithAWarning) {
    const ScratchFolder folder;
    const Outcome outcome = testing::run_grainfield(
        {"simulate", "md", "--grains", "60", "--length-x", "8", "--length-y", "8", "--periods",
         "1e9", "--force-size", "--explain", "-o", folder / "a.h5"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: the size is insisted on"));
}

// It gave "0 steps" and exit code 0.
TEST(NoStep, InTheTimeAskedForIsAnError) {
    const ScratchFolder folder;
    const Outcome outcome = testing::run_grainfield(
        {"simulate", "field", "--dt", "1e6", "--record", "200", "-o", folder / "f.h5"});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("no step fits into --relax and --record"));
    EXPECT_THAT(outcome.err, HasSubstr("--dt = 1e+06"));
    EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace grainfield
