// Cases 21 to 23 and 25 of docs/reliability.md: numbers that are none, and runs that cannot go on.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "core/version.h"
#include "io/h5/checkpoint_file.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/md_words.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::run_grainfield;
using testing::ScratchFolder;
using testing::with;
using testing::Words;

/// Two columns of a table with a header.
std::vector<Vec2> columns(const std::string& csv, const std::string& x, const std::string& y) {
    std::istringstream lines(csv);
    std::vector<std::string> names;
    std::vector<Vec2> found;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("#")) continue;
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
        if (names.empty()) {
            names = cells;
            continue;
        }
        Vec2 p{NAN, NAN};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (names[i] == x) p.x = std::stod(cells[i]);
            if (names[i] == y) p.y = std::stod(cells[i]);
        }
        found.push_back(p);
    }
    return found;
}

// One sweep with discs of half the size: many do not come to rest, some go astray.
TEST(Case21, AFitThatDoesNotConvergeIsRejectedAndCountedAndNeverWritten) {
    const ScratchFolder folder;
    const std::string picture = folder / "picture.png";
    testing::CrystalPatch patch;
    patch.radius = 0.26;
    testing::write_png(
        picture,
        testing::camera_frame(testing::crystal_in_liquid(640, 640, 12, 0.7, patch, 1), {}, 1));
    // Of discs far too small and sharp several crowd each sphere. Few are still on their way after
    // one sweep a round, and not with each size.
    std::int64_t unsettled = 0;
    std::int64_t rejected = 0;
    for (const auto& [diameter, edge] : {std::pair{"4.4", "0.25"}, std::pair{"4.6", "0.3"},
                                         std::pair{"4.8", "0.3"}, std::pair{"5.2", "0.25"}}) {
        SCOPED_TRACE(diameter);
        const Outcome outcome =
            run_grainfield({"track", picture, "-o", folder / "t.h5", "--force", "--json",
                            "--disc-diameter", diameter, "--edge-width", edge, "--max-sweeps", "1",
                            "--tolerance", "1e-6", "--region", "0,0,400,400"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const json summary = json::parse(outcome.out);
        unsettled += summary["unsettled"].get<std::int64_t>();
        rejected += summary["rejected"].get<std::int64_t>();
        ASSERT_EQ(
            run_grainfield({"export", folder / "t.h5", "-o", folder / "t.csv", "--force"}).code, 0);
        const auto points = columns(testing::read_all(folder / "t.csv"), "x", "y");
        EXPECT_EQ(points.size(), summary["particles_mean"]) << "those rejected are not counted";
        for (const Vec2 p : points) {
            EXPECT_TRUE(p.x > -0.5 && p.x < 399.5 && p.y > -0.5 && p.y < 399.5)
                << p.x << " " << p.y;
        }
    }
    EXPECT_GT(unsettled, 100);
    EXPECT_GT(rejected, 0);
}

// S(k) of so few points has no pre-peak that the fit could end before.
TEST(Case21, AFitOfACurveThatIsImpossibleGivesAReasonAndNoNumber) {
    const ScratchFolder folder;
    std::ofstream file(folder / "points.csv");
    file << "frame,particle,x,y\n";
    for (int frame = 0; frame < 9; ++frame) {
        for (int i = 0; i < 5; ++i) {
            file << frame << ',' << i << ',' << 1 + 1.7 * i << ',' << 1 + (frame * i) % 8 << '\n';
        }
    }
    file.close();
    const Outcome outcome = run_grainfield({"analyze", folder / "points.csv", "-o", folder / "r.h5",
                                            "--box", "10,10", "--sphere-diameter", "1", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json fit = json::parse(outcome.out)["fit"];
    EXPECT_FALSE(fit.contains("value")) << fit;
    EXPECT_THAT(fit.value("reason", ""), Not(::testing::IsEmpty()));
    EXPECT_THAT(outcome.out, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf,"))));
    ASSERT_EQ(run_grainfield({"export", folder / "r.h5", "-o", folder / "curves"}).code, 0);
    for (const auto& curve : fs::directory_iterator(folder / "curves")) {
        if (curve.path().filename() == "units.csv") continue;
        EXPECT_THAT(testing::read_all(curve.path()), Not(HasSubstr("nan"))) << curve.path();
    }
}

Words small_layer(const std::string& output) {
    return with(testing::small_md(), {"-o", output, "--periods", "400", "--snapshot-every", "7.3"});
}

TEST(Case22, InelasticCollapseAndAStalledClockEndWithFiveGrainAndTime) {
    for (const Words& loss :
         {Words{"--amplitude", "0", "--plate-restitution", "0.5", "--grain-restitution", "0.5"},
          Words{"--grain-restitution", "0", "--plate-restitution", "0"}}) {
        const ScratchFolder folder;
        const auto start = std::chrono::steady_clock::now();
        const Outcome outcome = run_grainfield(with(small_layer(folder / "a.h5"), loss));
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
        EXPECT_EQ(outcome.code, 5) << outcome.err;
        EXPECT_THAT(outcome.err, ::testing::ContainsRegex("collapse: grain [0-9]+"));
        EXPECT_THAT(outcome.err, ::testing::ContainsRegex("(period|time) [0-9.e+-]+"));
        EXPECT_THAT(outcome.err, HasSubstr("contact-time"));
    }
}

// Spheres that overlap in the state to start from are no state of hard spheres: a bad input.
TEST(Case22, AStartWithSpheresThatOverlapIsRefusedWithTheFrame) {
    const ScratchFolder folder;
    std::ofstream(folder / "start.csv")
        << "# grainfield points 1\n# box: 0,0,10,10,1.84\n# boundary: periodic,periodic\n"
           "# origin: md\n# length_unit: diameter\n# diameter: 1\nframe,particle,x,y,z,vx,vy,vz\n"
           "0,0,2,2,0.9,0,0,0\n0,1,2.5,2,0.9,0,0,0\n0,2,9,9,0.9,0,0,0\n";
    const Outcome outcome =
        run_grainfield({"simulate", "md", "--grains", "3", "--length-x", "10", "--length-y", "10",
                        "--start", folder / "start.csv", "-o", folder / "a.h5"});
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("start.csv"), HasSubstr("frame 0"),
                                   HasSubstr("spheres overlap by 0.5 a")));
    EXPECT_FALSE(fs::exists(folder / "a.h5"));
}

// Every observable of one frame, of one particle, of none: a value or a reason, never both missing.
TEST(Case23, TooFewFramesOrParticlesGiveAReasonInPlaceOfANumber) {
    for (const char* rows : {"0,0,5,5\n", "0,0,5,5\n0,1,6,5\n", "0,0,5,5\n1,0,5,6\n"}) {
        const ScratchFolder folder;
        std::ofstream(folder / "points.csv") << "frame,particle,x,y\n" << rows;
        const Outcome outcome =
            run_grainfield({"analyze", folder / "points.csv", "-o", folder / "r.h5", "--box",
                            "10,10", "--sphere-diameter", "1", "--json"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const json summary = json::parse(outcome.out);
        for (const char* name : {"q4", "phase", "msd", "sk", "s4", "variance", "fit"}) {
            const json& object = summary[name];
            EXPECT_TRUE(object.contains("value") || object.contains("reason")) << name << rows;
            for (const json& m : object["measurements"]) {
                EXPECT_TRUE(m.contains("value") || m.contains("reason")) << m;
                EXPECT_FALSE(m.contains("value") && !m["value"].is_number()) << m;
            }
        }
        EXPECT_FALSE(summary["msd"].contains("value")) << "no diffusion coefficient of two frames";
        EXPECT_THAT(summary["msd"].value("reason", ""), Not(::testing::IsEmpty()));
        EXPECT_FALSE(summary["fit"].contains("value"));
    }
    const ScratchFolder folder;
    std::ofstream(folder / "points.csv") << "frame,particle,x,y\n";
    const Outcome none = run_grainfield({"analyze", folder / "points.csv", "-o", folder / "r.h5",
                                         "--box", "10,10", "--sphere-diameter", "1", "--json"});
    EXPECT_EQ(none.code, 0) << none.err;
    EXPECT_THAT(none.err, HasSubstr("points.csv' has no particles"));
    const json summary = json::parse(none.out);
    for (const char* name : {"q4", "phase", "msd", "sk", "s4", "variance", "fit"}) {
        EXPECT_FALSE(summary[name].contains("value")) << name;
        EXPECT_THAT(summary[name].value("reason", ""), Not(::testing::IsEmpty())) << name;
    }
}

class Case25 : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    std::string checkpoint_ = folder_ / "a.h5.checkpoint";

    void interrupt(const Words& words) {
        const Process process(program(with(words, {"-o", folder_ / "a.h5"})));
        process.let_write(checkpoint_);
        process.send(SIGKILL);
        process.wait();
        ASSERT_TRUE(fs::exists(checkpoint_));
    }

    void expect_refused(const Words& words, const std::string& why) {
        const std::string before = testing::read_all(checkpoint_);
        const Outcome outcome = run_grainfield(with(words, {"-o", folder_ / "a.h5", "--resume"}));
        EXPECT_EQ(outcome.code, 3) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(HasSubstr("a.h5.checkpoint"), HasSubstr(why)));
        EXPECT_TRUE(testing::read_all(checkpoint_) == before);
        EXPECT_FALSE(fs::exists(folder_ / "a.h5"));
    }

    /// As long as `word`: the length of a text is stored before it.
    void replace_in_checkpoint(const std::string& word, const std::string& other) {
        std::string content = testing::read_all(checkpoint_);
        const std::size_t at = content.find(word);
        ASSERT_NE(at, std::string::npos);
        content.replace(at, other.size(), other);
        std::ofstream(checkpoint_, std::ios::binary) << content;
    }
};

TEST_F(Case25, ACheckpointOfAnotherConfigurationIsRefusedWithTheDifference) {
    const Words md = with(testing::small_md(), {"--periods", "100000", "--checkpoint-every", "0"});
    interrupt(md);
    expect_refused(with(md, {"--amplitude", "0.09"}),
                   "--amplitude: 0.08 in the checkpoint, 0.09 now");
    for (const char* leftover : {"a.h5.partial", "a.h5.snapshots", "a.h5.checkpoint"}) {
        fs::remove(folder_ / leftover);
    }
    const Words field{"simulate",           "field", "--nx", "128", "--record", "1e6",
                      "--checkpoint-every", "0.01"};
    interrupt(field);
    expect_refused(with(field, {"--nu", "0.5"}), "--nu: 0.01 in the checkpoint, 0.5 now");
}

// The signature is followed by the format's version.
TEST_F(Case25, ACheckpointOfAnotherFormatVersionIsRefusedWithBoth) {
    const Words md = with(testing::small_md(), {"--periods", "100000", "--checkpoint-every", "0"});
    interrupt(md);
    const std::string good = testing::read_all(checkpoint_);
    using namespace std::string_literals;
    replace_in_checkpoint("checkpoint\0\1"s, "checkpoint\0\2"s);
    expect_refused(md, "format version 2; expected version 1");
    std::ofstream(checkpoint_, std::ios::binary) << "something else altogether";
    expect_refused(md, "checkpoint");
    std::ofstream(checkpoint_, std::ios::binary) << good.substr(0, good.size() / 2);
    expect_refused(md, "checkpoint");
}

// A sound checkpoint in every other respect: its numbers may mean something else to this program.
TEST_F(Case25, ACheckpointOfAnotherProgramVersionIsRefusedWithBoth) {
    const Words md = with(testing::small_md(), {"--periods", "100000", "--checkpoint-every", "0"});
    interrupt(md);
    Checkpoint other = io::read_checkpoint(checkpoint_);
    ASSERT_EQ(other.texts["program version"], std::vector<std::string>{kVersion});
    other.texts["program version"] = {"0.0.7"};
    io::write_checkpoint(other, checkpoint_);
    expect_refused(md, "version 0.0.7 wrote it");
    expect_refused(md, std::string("version ") + kVersion);
    other.texts.erase("program version");
    io::write_checkpoint(other, checkpoint_);
    expect_refused(md, "it does not say which version wrote it");
}

}  // namespace
}  // namespace grainfield
