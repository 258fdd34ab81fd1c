// `grainfield track` with what a user knows of the picture: a region, a flat field, the cell.
#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class TrackOptions : public ::testing::Test {
 protected:
    Outcome track(const std::string& frame, std::vector<std::string> more) {
        std::vector<std::string> words{"track", "--force", "--json", "-o", folder_ / "t.h5", frame};
        words.insert(words.end(), more.begin(), more.end());
        return run_grainfield(words);
    }

    /// Rows of the last run: column name → value.
    std::vector<std::map<std::string, std::string>> rows() {
        EXPECT_EQ(
            run_grainfield({"export", "--force", folder_ / "t.h5", "-o", folder_ / "t.csv"}).code,
            0);
        std::istringstream csv(testing::read_all(folder_ / "t.csv"));
        std::vector<std::string> names;
        std::vector<std::map<std::string, std::string>> result;
        for (std::string line; std::getline(csv, line);) {
            if (line.empty() || line[0] == '#') continue;
            std::vector<std::string> fields;
            std::istringstream text(line);
            for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
            if (names.empty()) {
                names = fields;
                continue;
            }
            fields.resize(names.size());
            auto& row = result.emplace_back();
            for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = fields[i];
        }
        return result;
    }

    std::vector<Vec2> positions() {
        std::vector<Vec2> found;
        for (auto& row : rows()) found.push_back({std::stod(row["x"]), std::stod(row["y"])});
        return found;
    }

    ScratchFolder folder_;
};

double nearest(const std::vector<Vec2>& points, Vec2 p) {
    double least = 1e9;
    for (const Vec2 q : points) least = std::min(least, norm(q - p));
    return least;
}

TEST_F(TrackOptions, PositionsInARegionAreThoseOfTheWholeFrame) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--region", "40,25,120,130"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::vector<Vec2> found = positions();
    int expected = 0;
    for (const Vec2 p : testing::few_discs().position) {
        const bool inside = p.x > 40 + 5 && p.x < 160 - 5 && p.y > 25 + 5 && p.y < 155 - 5;
        expected += inside;
        // Some 15 standard errors.
        if (!inside) continue;
        EXPECT_LT(nearest(found, p), 0.15);
    }
    EXPECT_GE(static_cast<int>(found.size()), expected);
    EXPECT_GT(expected, 30);
    for (const Vec2 p : found) {
        EXPECT_TRUE(p.x >= 39.5 && p.x <= 159.5 && p.y >= 24.5 && p.y <= 154.5);
    }
}

TEST_F(TrackOptions, ARegionOutsideTheFrameIsRefused) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--region", "100,0,120,100"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("192 x 192"));
}

TEST_F(TrackOptions, AFlatFieldTakesOutAnEdgeInTheLight) {
    // Half of the frame behind a grey filter: no smooth background can follow that.
    const auto scene = testing::few_discs();
    Image frame = testing::disc_frame(scene, 0);
    Image flat(frame.width(), frame.height(), 200);
    for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < frame.width() / 2; ++x) {
            frame(x, y) = std::round(0.5F * frame(x, y));
            flat(x, y) = 100;
        }
    }
    testing::write_png(folder_ / "frame.png", frame);
    testing::write_png(folder_ / "flat.png", flat);
    const Outcome plain = track(folder_ / "frame.png", {});
    const double residual_before =
        plain.code == 0 ? json::parse(plain.out)["residual_rms"].get<double>() : 1;
    const Outcome outcome = track(folder_ / "frame.png", {"--flat-field", folder_ / "flat.png"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_LT(json::parse(outcome.out)["residual_rms"], 0.6 * residual_before);
    const std::vector<Vec2> found = positions();
    EXPECT_EQ(found.size(), scene.position.size());
    for (const Vec2 p : scene.position) EXPECT_LT(nearest(found, p), 0.2);
}

TEST_F(TrackOptions, TheHeightOfTheCellNamesLayers) {
    testing::CrystalPatch patch;
    patch.radius = 0.3;
    const auto scene = testing::crystal_in_liquid(320, 320, 14, 0.6, patch, 3);
    testing::write_png(folder_ / "frame.png", testing::camera_frame(scene, {}, 1));
    const Outcome outcome =
        track(folder_ / "frame.png", {"--height", "1.94", "--sphere-diameter", "14"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json layers = json::parse(outcome.out)["layers"];
    EXPECT_EQ(layers["contradictory"], 0);
    EXPECT_EQ(layers["rejected_pairs"], 0);
    int right = 0;
    int labelled = 0;
    for (auto& row : rows()) {
        if (row["layer"].empty()) continue;
        const Vec2 p{std::stod(row["x"]), std::stod(row["y"])};
        for (std::size_t i = 0; i < scene.position.size(); ++i) {
            if (norm(scene.position[i] - p) > 3) continue;
            if (scene.layer[i] == Layer::unknown) continue;
            ++labelled;
            right += std::stoi(row["layer"]) == static_cast<int>(scene.layer[i]);
        }
    }
    const auto crystal = static_cast<int>(scene.position.size() - scene.crystal_begin);
    EXPECT_GT(labelled, 9 * crystal / 10);
    // One cluster, the right way up or upside down.
    EXPECT_TRUE(right == 0 || right == labelled) << right << " of " << labelled;
}

TEST_F(TrackOptions, TheHeightIsOfNoUseWithoutTheDiameter) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--height", "1.94"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--sphere-diameter"));
}

}  // namespace
}  // namespace grainfield
