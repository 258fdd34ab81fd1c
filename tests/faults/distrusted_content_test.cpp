// Cases 12 to 14 of docs/reliability.md: what is inside a file is not believed.
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "core/support/random.h"
#include "tests/faults/bad_input.h"
#include "tests/support/disc_sequence.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_grainfield;

class DistrustedContent : public testing::BadInput {
 protected:
    /// A good trajectory of two frames.
    std::string tracked() {
        const auto frames = testing::write_disc_sequence(folder_, 2);
        const std::string path = folder_ / "tracks.h5";
        EXPECT_EQ(run_grainfield({"track", frames[0], frames[1], "-o", path}).code, 0);
        return path;
    }

    /// A copy of it that `change` makes into something else, with the C library.
    std::string changed(const std::string& original, const std::function<void(hid_t)>& change) {
        const std::string path = folder_ / "changed.h5";
        fs::copy_file(original, path, fs::copy_options::overwrite_existing);
        const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        EXPECT_GE(file, 0);
        change(file);
        EXPECT_GE(H5Fclose(file), 0);
        return path;
    }

    Outcome analyze(const std::string& file) {
        return run_grainfield(
            {"analyze", file, "-o", out_ / "r.h5", "--observables", "q4", "--force"});
    }
};

using Case12 = DistrustedContent;
using Case13 = DistrustedContent;
using Case14 = DistrustedContent;

TEST_F(Case12, ATruncatedTrajectoryOrResultsFileIsRefused) {
    const std::string frame = testing::write_disc_sequence(folder_, 1)[0];
    const std::string tracks = folder_ / "tracks.h5";
    const std::string results = folder_ / "results.h5";
    ASSERT_EQ(run_grainfield({"track", frame, "-o", tracks}).code, 0);
    ASSERT_EQ(run_grainfield({"analyze", tracks, "-o", results}).code, 0);
    for (const double fraction : {0.9, 0.05}) {
        for (const std::string& file : {tracks, results}) {
            const std::string cut = folder_ / "cut.h5";
            fs::copy_file(file, cut, fs::copy_options::overwrite_existing);
            testing::truncate_file(cut, fraction);
            expect_refused_by_all(cut);
        }
    }
}

TEST_F(Case12, MalformedOrForeignHdf5IsRefused) {
    const std::string good = tracked();
    ASSERT_EQ(analyze(good).code, 0);
    fs::remove(out_ / "r.h5");
    const char* const group_name = "particles/trajectory/";
    for (const char* gone :
         {"h5md", "particles", "position", "position/value", "position/step", "box"}) {
        const std::string name = std::string(gone) == "h5md" || std::string(gone) == "particles"
                                     ? gone
                                     : std::string(group_name) + gone;
        const std::string file = changed(good, [&](hid_t h5) {
            EXPECT_GE(H5Ldelete(h5, name.c_str(), H5P_DEFAULT), 0) << name;
        });
        const Outcome outcome = analyze(file);
        EXPECT_EQ(outcome.code, 3) << name << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(file)) << name;
    }
    // A group where numbers are expected.
    const std::string group = changed(good, [&](hid_t h5) {
        H5Ldelete(h5, "particles/trajectory/position/value", H5P_DEFAULT);
        H5Gclose(H5Gcreate2(h5, "particles/trajectory/position/value", H5P_DEFAULT, H5P_DEFAULT,
                            H5P_DEFAULT));
    });
    EXPECT_EQ(analyze(group).code, 3);
    // The numbers of another program.
    const std::string foreign = folder_ / "foreign.h5";
    const hid_t file = H5Fcreate(foreign.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, "measurement", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(file);
    expect_refused_by_all(foreign);
    EXPECT_EQ(out_.entries(), 0U);
}

// Checksums of the data find them, or they hit what is not read.
TEST_F(Case12, DamagedBytesAnywhereAreRefusedOrHarmless) {
    const std::string good = testing::read_all(tracked());
    RandomStream random(3, "damage");
    int refused = 0;
    for (int i = 0; i < 16; ++i) {
        std::string bad = good;
        const std::size_t at = random.below(good.size() - 16);
        for (std::size_t k = 0; k < 16; ++k) bad[at + k] = static_cast<char>(random.below(256));
        const std::string file = write("damaged.h5", bad);
        const Outcome outcome = analyze(file);
        EXPECT_THAT(outcome.code, AnyOf(0, 3)) << "bytes from " << at << ": " << outcome.err;
        if (outcome.code == 0) continue;
        EXPECT_THAT(outcome.err, HasSubstr(file)) << at;
        ++refused;
    }
    EXPECT_GT(refused, 3);
}

TEST_F(Case13, WhatAFileSaysOfOtherFilesIsNotFollowed) {
    const std::string good = tracked();
    const std::string link = changed(good, [&](hid_t h5) {
        H5Ldelete(h5, "particles", H5P_DEFAULT);
        H5Lcreate_external("../../etc/tracks.h5", "/particles", h5, "particles", H5P_DEFAULT,
                           H5P_DEFAULT);
    });
    Outcome outcome = analyze(link);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(link), HasSubstr("another file")));
    // A good file at its end makes no difference.
    const std::string near = changed(good, [&](hid_t h5) {
        H5Ldelete(h5, "particles", H5P_DEFAULT);
        H5Lcreate_external("tracks.h5", "/particles", h5, "particles", H5P_DEFAULT, H5P_DEFAULT);
    });
    outcome = analyze(near);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("another file"));
    // A list of films, as libav reads it.
    const std::string list = write("list.avi", "ffconcat version 1.0\nfile frame_000.png\n");
    expect_refused_by_all(list);
    EXPECT_EQ(out_.entries(), 0U);
}

TEST_F(Case13, ALinkInPlaceOfALogIsRefused) {
    fs::create_symlink("/dev/null", out_ / "x.h5.fields");
    const Outcome outcome =
        run_grainfield({"simulate", "field", "--nx", "32", "-o", out_ / "x.h5"});
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("x.h5.fields"), HasSubstr("a symbolic link"),
                                   Not(HasSubstr("free space"))));
}

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++n;
    }
    return n;
}

// Label, name of the file, title. A report of the same points without hostile names has as many
// scripts, pictures and handlers.
TEST_F(Case14, ScriptInNamesOrConfigurationIsInertInTheReport) {
    const std::string hostile = "</script><script>alert(1)</script><img src=x onerror=alert(2)>";
    const std::string points = "frame,x,y\n0,1,2\n0,2,2\n0,3,2\n0,2,1\n0,2,3\n";
    std::vector<std::string> pages;
    for (const bool is_hostile : {false, true}) {
        const std::string name = is_hostile ? "<img src=x onerror=alert(3)>.csv" : "good.csv";
        const std::string label = is_hostile ? hostile : "good";
        std::ofstream(folder_ / "run.toml") << "label = \"" << label << "\"\n";
        const std::string results = folder_ / "results.h5";
        const Outcome analysis =
            run_grainfield({"analyze", write(name, points), "-o", results, "--force", "-c",
                            folder_ / "run.toml", "--box", "10,10", "--sphere-diameter", "1"});
        ASSERT_EQ(analysis.code, 0) << analysis.err;
        const Outcome report = run_grainfield({"compare", results, "-o", out_ / "r.html", "--title",
                                               label, "--no-figures", "--force"});
        ASSERT_EQ(report.code, 0) << report.err;
        pages.push_back(testing::read_all(out_ / "r.html"));
    }
    EXPECT_THAT(pages[1], HasSubstr("&lt;script&gt;alert(1)"));
    for (const char* active : {"<script", "</script", "<img", "onerror=alert(2)>"}) {
        EXPECT_EQ(count_of(pages[1], active), count_of(pages[0], active)) << active;
    }
}

TEST_F(Case14, ControlCharactersOfNamesDoNotReachTheTerminal) {
    const Outcome outcome = run_grainfield({"info", "a\x1b[31mb.h5"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("a\\x1b[31mb.h5"), Not(HasSubstr("\x1b"))));
}

}  // namespace
}  // namespace grainfield
