#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class BadInput : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    ScratchFolder out_;

    // Every command refuses the file with code 3, names it, and leaves nothing behind.
    void expect_refused_by_all(const std::string& input) {
        const std::vector<std::vector<std::string>> calls{{"track", input, "-o", out_ / "t.h5"},
                                                          {"analyze", input, "-o", out_ / "r.h5"},
                                                          {"compare", input, "-o", out_ / "r.html"},
                                                          {"export", input, "-o", out_ / "x.csv"},
                                                          {"info", input}};
        for (const auto& words : calls) {
            const Outcome outcome = run_grainfield(words);
            EXPECT_EQ(outcome.code, 3) << words[0] << " " << input << ": " << outcome.err;
            EXPECT_THAT(outcome.err, HasSubstr(input));
            EXPECT_EQ(outcome.out, "");
            EXPECT_EQ(out_.entries(), 0U) << words[0];
        }
    }

    std::string write(const std::string& name, const std::string& content) {
        const std::string path = folder_ / name;
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }
};

TEST_F(BadInput, MissingIsRefused) {
    for (const char* name : {"missing.tif", "missing.png", "missing.avi", "missing.h5"}) {
        expect_refused_by_all(folder_ / name);
    }
}

TEST_F(BadInput, EmptyIsRefused) {
    for (const char* name : {"empty.tif", "empty.png", "empty.avi", "empty.h5", "empty.csv"}) {
        expect_refused_by_all(write(name, ""));
    }
}

TEST_F(BadInput, ADirectoryIsRefused) {
    fs::create_directory(folder_ / "folder.tif");
    expect_refused_by_all(folder_ / "folder.tif");
}

TEST_F(BadInput, TextUnderAnImageVideoOrDataNameIsRefused) {
    for (const char* name : {"text.tif", "text.png", "text.avi", "text.h5"}) {
        expect_refused_by_all(write(name, "This is not what its name says.\n"));
    }
}

TEST_F(BadInput, RandomBytesBehindAGoodSignatureAreRefused) {
    std::string noise;
    RandomStream random(1, "bad bytes");
    for (int i = 0; i < 4096; ++i) noise.push_back(static_cast<char>(random.below(256)));
    expect_refused_by_all(write("noise.png", "\x89PNG\r\n\x1a\n" + noise));
    expect_refused_by_all(write("noise.tif", std::string("II*\0", 4) + noise));
    expect_refused_by_all(write("noise.h5", "\x89HDF\r\n\x1a\n" + noise));
}

TEST_F(BadInput, ATruncatedTrajectoryOrResultsFileIsRefused) {
    const std::string frame = testing::write_disc_sequence(folder_, 1)[0];
    const std::string tracks = folder_ / "tracks.h5";
    const std::string results = folder_ / "results.h5";
    ASSERT_EQ(run_grainfield({"track", frame, "-o", tracks}).code, 0);
    ASSERT_EQ(run_grainfield({"analyze", tracks, "-o", results}).code, 0);
    for (const double fraction : {0.9, 0.5, 0.05}) {
        for (const std::string& file : {tracks, results}) {
            const std::string cut = folder_ / "cut.h5";
            fs::copy_file(file, cut, fs::copy_options::overwrite_existing);
            testing::truncate_file(cut, fraction);
            expect_refused_by_all(cut);
        }
    }
}

TEST_F(BadInput, PointsThatAreNotNumbersAreRefusedWithTheirLine) {
    const std::string points = write("points.csv", "frame,particle,x,y\n0,0,1,2\n0,1,three,4\n");
    const Outcome outcome =
        run_grainfield({"analyze", points, "-o", out_ / "r.h5", "--box", "10,10"});
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(points));
    EXPECT_THAT(outcome.err, HasSubstr("3"));
    EXPECT_EQ(out_.entries(), 0U);
}

}  // namespace
}  // namespace grainfield
