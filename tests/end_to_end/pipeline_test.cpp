#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/version.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;
using ::testing::StartsWith;

/// Frames → tracks → results, made once for all cases.
class Pipeline : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = new ScratchFolder;
        frames_ = testing::write_disc_sequence(*folder_, 5);
        std::vector<std::string> words{"track", "-o", tracks(), "--json", "--seed", "7"};
        words.insert(words.end(), frames_.begin(), frames_.end());
        track_ = run_grainfield(words);
        analyze_ = run_grainfield({"analyze", tracks(), "-o", results(), "--json"});
    }
    static void TearDownTestSuite() { delete folder_; }

    static std::string tracks() { return *folder_ / "tracks.h5"; }
    static std::string results() { return *folder_ / "results.h5"; }

    static inline ScratchFolder* folder_ = nullptr;
    static inline std::vector<std::string> frames_;
    static inline Outcome track_, analyze_;
};

TEST_F(Pipeline, TrackPrintsOneObjectWithTheKeysThatScriptsRelyOn) {
    ASSERT_EQ(track_.code, 0) << track_.err;
    const json summary = json::parse(track_.out);
    EXPECT_EQ(summary["command"], "track");
    EXPECT_EQ(summary["version"], kVersion);
    EXPECT_EQ(summary["seed"], 7);
    EXPECT_GE(summary["threads"], 1);
    EXPECT_GT(summary["seconds"], 0);
    EXPECT_TRUE(summary["skipped"].is_array());
    EXPECT_TRUE(summary["warnings"].is_array());
    EXPECT_EQ(summary["outputs"], json{tracks()});
    for (const char* stage : {"detect", "refine", "link", "read", "write"}) {
        EXPECT_GE(summary["ms_per_frame"][stage], 0) << stage;
    }
    EXPECT_GT(summary["work_per_frame"]["disc_updates"], 0);
    EXPECT_GT(summary["work_per_frame"]["joint_steps"], 0);
}

TEST_F(Pipeline, TrackFindsEveryDiscAndTheirSizeWithoutAnyOption) {
    const json summary = json::parse(track_.out);
    EXPECT_EQ(summary["frames"], 5);
    EXPECT_EQ(summary["particles_mean"], testing::few_discs().position.size());
    // Edge fits average over some 100 discs: 0.1 px and 0.1 px are many standard errors.
    EXPECT_NEAR(summary["diameter_px"].get<double>(), testing::kApparentDiameter, 0.1);
    EXPECT_NEAR(summary["edge_width_px"].get<double>(), testing::kEdgeWidth, 0.1);
    // The noise is 2 % of the contrast.
    EXPECT_NEAR(summary["residual_rms"].get<double>(), 0.02, 0.005);
    EXPECT_EQ(summary["binning"], 1);
    EXPECT_THAT(summary["binning_reason"].get<std::string>(), HasSubstr("true diameter"));
}

TEST_F(Pipeline, ExportedPointsHaveTheAgreedColumnsAndOneRowPerParticleAndFrame) {
    const std::string csv = *folder_ / "tracks.csv";
    const Outcome outcome = run_grainfield({"export", tracks(), "-o", csv, "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string text = testing::read_all(csv);
    EXPECT_THAT(text, StartsWith("frame,particle,x,y,"));
    EXPECT_THAT(testing::read_all(csv + ".meta"), StartsWith("# grainfield points 1\n"));
    const auto rows = static_cast<std::size_t>(std::ranges::count(text, '\n'));
    EXPECT_EQ(rows, 1 + 5 * testing::few_discs().position.size());
    const std::string xyz = *folder_ / "tracks.xyz";
    ASSERT_EQ(run_grainfield({"export", tracks(), "-o", xyz}).code, 0);
    EXPECT_THAT(testing::read_all(xyz),
                StartsWith(std::to_string(testing::few_discs().position.size()) + "\n"));
}

TEST_F(Pipeline, AnalyzeReportsEveryObservableWithAValueOrAReason) {
    ASSERT_EQ(analyze_.code, 0) << analyze_.err;
    const json summary = json::parse(analyze_.out);
    EXPECT_EQ(summary["command"], "analyze");
    for (const char* observable : {"q4", "phase", "msd", "sk", "variance"}) {
        ASSERT_TRUE(summary.contains(observable)) << observable;
        const json& object = summary[observable];
        EXPECT_TRUE(object.contains("value") || object.contains("reason")) << observable;
        EXPECT_TRUE(object["seconds"].is_number()) << observable;
        for (const json& m : object["measurements"]) {
            EXPECT_TRUE(m.contains("value") || m.contains("reason")) << m;
            EXPECT_FALSE(m.contains("value") && m["value"].is_null()) << m;
        }
    }
}

TEST_F(Pipeline, AnalyzeSaysWhereItsLengthsComeFrom) {
    const json lengths = json::parse(analyze_.out)["lengths"]["measurements"];
    const auto called = [&](const char* name) {
        const auto found =
            std::ranges::find_if(lengths, [&](const json& m) { return m["name"] == name; });
        return found == lengths.end() ? json() : *found;
    };
    ASSERT_TRUE(called("particle_diameter").is_object());
    EXPECT_THAT(called("particle_diameter")["reason"].get<std::string>(),
                HasSubstr("apparent diameter"));
    const json track = json::parse(track_.out);
    EXPECT_EQ(lengths[1]["value"], track["diameter_px"]);
    EXPECT_EQ(lengths[2]["value"], track["edge_width_px"]);
    EXPECT_EQ(lengths[3]["value"], track["residual_rms"]);
    EXPECT_GT(called("film_length")["value"].get<double>(), 0);
}

TEST_F(Pipeline, ResultsExportAsOneCsvPerCurve) {
    const std::string curves = *folder_ / "curves";
    const Outcome outcome = run_grainfield({"export", results(), "-o", curves});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(testing::read_all(curves + "/sk.csv"), StartsWith("k,s,s_err,n\n"));
    EXPECT_THAT(testing::read_all(curves + "/variance.csv"), StartsWith("l,variance,err,mean\n"));
    EXPECT_THAT(testing::read_all(curves + "/msd.csv"), StartsWith("t,phase,msd,err"));
    EXPECT_THAT(testing::read_all(curves + "/q4.csv"),
                StartsWith("frame,particle,q4_re,q4_im,n_neighbours\n"));
}

TEST_F(Pipeline, ExportedPointsGiveTheSameNumbersAsTheTracksThemselves) {
    const std::string csv = *folder_ / "points.csv";
    ASSERT_EQ(run_grainfield({"export", tracks(), "-o", csv, "--digits", "all"}).code, 0);
    const Outcome outcome =
        run_grainfield({"analyze", csv, "-o", *folder_ / "points.h5", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json from_csv = json::parse(outcome.out);
    const json from_h5 = json::parse(analyze_.out);
    // The text of a number reads back to the same number, and the file beside it says the rest.
    for (const char* observable : {"q4", "phase", "msd", "sk", "variance"}) {
        EXPECT_EQ(from_csv[observable]["measurements"], from_h5[observable]["measurements"])
            << observable;
    }
}

TEST_F(Pipeline, CompareWritesOnePageOfSeveralResults) {
    const std::string page = *folder_ / "report.html";
    const Outcome outcome =
        run_grainfield({"compare", results(), results(), "-o", page, "--title", "Two <runs>"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string html = testing::read_all(page);
    EXPECT_THAT(html, HasSubstr("Two &lt;runs&gt;"));
    EXPECT_EQ(html.find("Two <runs>"), std::string::npos);
    EXPECT_TRUE(std::filesystem::is_directory(*folder_ / "report_files"));
}

TEST_F(Pipeline, InfoTellsWhatEveryFileHolds) {
    const auto kind = [](const std::string& file) {
        const Outcome outcome = run_grainfield({"info", file, "--json"});
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return json::parse(outcome.out)["kind"].get<std::string>();
    };
    EXPECT_EQ(kind(tracks()), "trajectory");
    EXPECT_EQ(kind(results()), "results");
    EXPECT_EQ(kind(frames_[0]), "frames");
    const Outcome words = run_grainfield({"info", tracks()});
    EXPECT_THAT(words.out, HasSubstr("grainfield track"));
    EXPECT_THAT(words.out, HasSubstr("crc32:"));
    EXPECT_THAT(words.out, HasSubstr("192 x 192 px"));
}

TEST_F(Pipeline, OneTwoAndEightThreadsGiveTheSameBytes) {
    std::vector<std::string> points, curves;
    for (const char* threads : {"1", "2", "8"}) {
        const std::string stem = *folder_ / (std::string("threads") + threads);
        std::vector<std::string> words{"track", "-o", stem + ".h5", "--threads", threads};
        words.insert(words.end(), frames_.begin(), frames_.end());
        ASSERT_EQ(run_grainfield(words).code, 0);
        ASSERT_EQ(
            run_grainfield({"export", stem + ".h5", "-o", stem + ".csv", "--digits", "all"}).code,
            0);
        ASSERT_EQ(run_grainfield(
                      {"analyze", stem + ".h5", "-o", stem + "-results.h5", "--threads", threads})
                      .code,
                  0);
        ASSERT_EQ(run_grainfield({"export", stem + "-results.h5", "-o", stem}).code, 0);
        points.push_back(testing::read_all(stem + ".csv"));
        curves.push_back(testing::read_all(stem + "/sk.csv") + testing::read_all(stem + "/q4.csv") +
                         testing::read_all(stem + "/variance.csv"));
    }
    EXPECT_GT(points[0].size(), 1000U);
    EXPECT_GT(curves[0].size(), 1000U);
    EXPECT_EQ(points[0], points[1]);
    EXPECT_EQ(points[0], points[2]);
    EXPECT_EQ(curves[0], curves[1]);
    EXPECT_EQ(curves[0], curves[2]);
}

TEST_F(Pipeline, AFrameRangeKeepsTheIndicesOfTheSource) {
    const std::string some = *folder_ / "some.h5";
    std::vector<std::string> words{"track", "-o",    some, "--frames",
                                   "1:5:2", "--fps", "10", "--json"};
    words.insert(words.end(), frames_.begin(), frames_.end());
    const Outcome outcome = run_grainfield(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(json::parse(outcome.out)["frames"], 2);
    ASSERT_EQ(run_grainfield({"export", some, "-o", *folder_ / "some.csv"}).code, 0);
    const std::string text = testing::read_all(*folder_ / "some.csv");
    EXPECT_THAT(text, HasSubstr("\n1,"));
    EXPECT_THAT(text, HasSubstr("\n3,"));
    EXPECT_EQ(text.find("\n0,"), std::string::npos);
    EXPECT_EQ(text.find("\n2,"), std::string::npos);
}

}  // namespace
}  // namespace grainfield
