#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
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

TEST_F(Package, ManualPagesAndCompletionsAreWhereManAndTheShellsLook) {
    namespace fs = std::filesystem;
    const fs::path share = fs::path(prefix()) / "share";
    for (const char* file :
         {"man/man1/grainfield.1", "man/man1/grainfield-simulate-md.1",
          "bash-completion/completions/grainfield", "zsh/site-functions/_grainfield",
          "fish/vendor_completions.d/grainfield.fish"}) {
        EXPECT_TRUE(fs::exists(share / file)) << file;
    }
}

/// Configures and builds a project of tests/end_to_end against the installed package.
std::string built(const std::string& project, const std::string& build, const std::string& prefix) {
    const Outcome configured =
        run({GRAINFIELD_CMAKE, "-S", GRAINFIELD_SOURCE_DIR "/tests/end_to_end/" + project, "-B",
             build, "-G", "Ninja", "-DCMAKE_CXX_COMPILER=" GRAINFIELD_COMPILER,
             "-DCMAKE_PREFIX_PATH=" + prefix});
    if (configured.code != 0) return configured.out + configured.err;
    const Outcome made = run({GRAINFIELD_CMAKE, "--build", build});
    return made.code == 0 ? "" : made.out + made.err;
}

TEST_F(Package, AProgramThatAnalysesNeedsOnlyWhatTheAnalysisNeeds) {
    const std::string build = *folder_ / "build-analysis";
    ASSERT_EQ(built("analysis_consumer", build, prefix()), "");
    const Outcome outcome = run({build + "/analysis_consumer"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "1.000\n");
}

TEST_F(Package, HeadersIncludeOnlyHeadersThatAreInstalled) {
    namespace fs = std::filesystem;
    const fs::path root = fs::path(prefix()) / "include/grainfield";
    const std::regex include("#include \"([a-z]+/[^\"]+)\"");
    int headers = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const std::string name = entry.path().filename();
        EXPECT_NE(name, "detail") << entry.path();
        EXPECT_FALSE(name.ends_with("-inl.h")) << entry.path();
        if (!entry.is_regular_file()) continue;
        ++headers;
        std::ifstream file(entry.path());
        for (std::string line; std::getline(file, line);) {
            std::smatch found;
            if (!std::regex_match(line, found, include)) continue;
            EXPECT_TRUE(fs::exists(root / found[1].str())) << entry.path() << ": " << found[1];
        }
    }
    EXPECT_GT(headers, 50);
}

TEST_F(Package, AProgramOutsideTheTreeFindsCompilesAndLinksTheLibraries) {
    const std::string build = *folder_ / "build";
    ASSERT_EQ(built("consumer", build, prefix()), "");

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
