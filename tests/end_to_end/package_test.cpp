#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/version.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using testing::Outcome;
using testing::Process;
using testing::ScratchFolder;

Outcome run(std::vector<std::string> words) {
    return Process(std::move(words)).wait();
}

/// Installs this build into a folder of its own, once for all cases.
class Package : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = new ScratchFolder;
        install_ =
            run({GRAINFIELD_CMAKE, "--install", GRAINFIELD_BINARY_DIR, "--prefix", prefix()});
    }
    static void TearDownTestSuite() { delete folder_; }
    void SetUp() override { ASSERT_EQ(install_.code, 0) << install_.out << install_.err; }

    static std::string prefix() { return *folder_ / "prefix"; }

    static inline ScratchFolder* folder_ = nullptr;
    static inline Outcome install_;
};

TEST_F(Package, TheInstalledProgramRuns) {
    const Outcome outcome = run({prefix() + "/bin/grainfield", "--version"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, std::string("grainfield ") + kVersion + "\n");
}

TEST_F(Package, AProgramOutsideTheTreeFindsCompilesAndLinksTheLibraries) {
    const std::string build = *folder_ / "build";
    const Outcome configured =
        run({GRAINFIELD_CMAKE, "-S", GRAINFIELD_SOURCE_DIR "/tests/end_to_end/consumer", "-B",
             build, "-G", "Ninja", "-DCMAKE_CXX_COMPILER=" GRAINFIELD_COMPILER,
             "-DCMAKE_PREFIX_PATH=" + prefix()});
    ASSERT_EQ(configured.code, 0) << configured.out << configured.err;
    const Outcome built = run({GRAINFIELD_CMAKE, "--build", build});
    ASSERT_EQ(built.code, 0) << built.out << built.err;

    // A square lattice of 5 × 5 points: the 9 inside have four neighbours at right angles.
    const std::string points = *folder_ / "points.csv";
    std::ofstream table(points);
    table << "frame,x,y\n";
    for (int i = 0; i < 25; ++i) table << "0," << i % 5 << ',' << i / 5 << '\n';
    table.close();
    const Outcome outcome = run({build + "/consumer", points});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 25) << outcome.out;
    EXPECT_EQ(outcome.out.substr(6 * 12, 5), "1.000");
}

}  // namespace
}  // namespace grainfield
