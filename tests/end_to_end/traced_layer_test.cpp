// A ray-traced frame of a bilayer crystal in a liquid, with its truth (data-samples/README.md):
// what the README claims of a real frame that may not be passed on, held to on one that may.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/vec2.h"
#include "tests/support/csv_rows.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;

constexpr double kDiameter = 10.09;  // a [px]
const std::string kFrame = GRAINFIELD_SOURCE_DIR "/data-samples/traced-layer.png";
const std::string kTruth = GRAINFIELD_SOURCE_DIR "/data-samples/traced-layer-true.csv";

json facts_of(std::vector<std::string> words) {
    words.emplace_back("--json");
    const testing::Outcome outcome = testing::run_grainfield(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json::parse(outcome.out);
}

std::vector<Vec2> points_of(const std::string& path) {
    std::vector<Vec2> points;
    for (auto& row : testing::csv_rows(path)) {
        points.push_back({std::stod(row["x"]), std::stod(row["y"])});
    }
    return points;
}

/// Distances to the four nearest points, in ascending order [px].
std::array<double, 4> nearest_four(const std::vector<Vec2>& points, std::size_t of) {
    std::array<double, 4> nearest;
    nearest.fill(std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i == of) continue;
        const double distance = norm(points[i] - points[of]);
        if (distance >= nearest.back()) continue;
        nearest.back() = distance;
        std::ranges::sort(nearest);
    }
    return nearest;
}

/// Median over the crystal in the middle of the mean distance to the four nearest [a].
double lattice_spacing(const std::vector<Vec2>& points) {
    std::vector<double> spacing;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::abs(points[i].x - 506) > 90 || std::abs(points[i].y - 506) > 90) continue;
        const auto nearest = nearest_four(points, i);
        spacing.push_back((nearest[0] + nearest[1] + nearest[2] + nearest[3]) / (4 * kDiameter));
    }
    std::ranges::sort(spacing);
    return spacing.at(spacing.size() / 2);
}

double measured(const json& observable, const std::string& name) {
    for (const json& m : observable.at("measurements")) {
        if (m.at("name") == name) return m.at("value");
    }
    ADD_FAILURE() << "no measurement " << name;
    return std::numeric_limits<double>::quiet_NaN();
}

class TracedLayer : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = new testing::ScratchFolder;
        tracked_ = facts_of({"track", kFrame, "--sphere-diameter", "10.09", "-o", path("t.h5")});
        facts_of({"export", path("t.h5"), "-o", path("t.csv")});
        points_ = points_of(path("t.csv"));
        truth_ = points_of(kTruth);
    }
    static void TearDownTestSuite() { delete folder_; }
    static std::string path(const char* name) { return *folder_ / name; }

    static inline testing::ScratchFolder* folder_ = nullptr;
    static inline json tracked_;
    static inline std::vector<Vec2> points_, truth_;
};

// The frame is fixed, but rounding differs from processor to processor, and doubtful spheres with
// it: 29 missed and 17 false of 9,860 with AVX2 (.1616 px), 8 and 24 with AVX-512 (.1591 px). The
// bars leave a tenth beyond the worse of both.
TEST_F(TracedLayer, FindsAllButThreeInAThousandSpheres) {
    const json score = facts_of({"validate", kFrame, "--truth", kTruth, "--sphere-diameter",
                                 "10.09", "-o", path("v.html")});
    const json& all = score.at("classes").at("all");
    EXPECT_GT(all.at("matched").get<int>(), 9800);
    EXPECT_LE(all.at("missed").get<int>(), 32);
    EXPECT_LE(all.at("spurious").get<int>(), 27);
    EXPECT_LE(all.at("missed").get<int>() + all.at("spurious").get<int>(), 50);
    EXPECT_LT(all.at("rmse_px").get<double>(), 0.178);
}

TEST_F(TracedLayer, TheDiscsHaveTheSizeThatTheRealFrameShows) {
    // 8.9 ± .3 px and 1.25 ± .15 px there; the camera was fitted to it.
    EXPECT_NEAR(tracked_.at("diameter_px").get<double>(), 8.9, 0.3);
    EXPECT_NEAR(tracked_.at("edge_width_px").get<double>(), 1.25, 0.15);
    EXPECT_LT(tracked_.at("residual_rms").get<double>(), 0.085);
}

TEST_F(TracedLayer, HardlyAnyPairIsCloserThanTheCellAllows) {
    // Two spheres between plates 1.94 a apart differ in height by .94 a at most.
    const double least = kDiameter * std::sqrt(1 - 0.94 * 0.94);
    int closer = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) closer += nearest_four(points_, i)[0] < least;
    EXPECT_LE(closer, 2 * 17);  // a false sphere takes one true partner with it
}

TEST_F(TracedLayer, TheCrystalHasTheProjectedSpacingOfTheTruth) {
    // Of n = 330 spheres with errors of .17 px in two coordinates each: .17 px / sqrt(n) and the
    // median's 1.25.
    const double true_spacing = lattice_spacing(truth_);
    EXPECT_NEAR(true_spacing, 0.81, 0.02);
    EXPECT_NEAR(lattice_spacing(points_), true_spacing,
                5 * 1.25 * 0.17 / kDiameter / std::sqrt(330));
}

TEST_F(TracedLayer, TheMinimumBetweenLiquidAndSolidIsWhereTheTruthHasIt) {
    const json found =
        facts_of({"analyze", path("t.h5"), "--observables", "q4", "-o", path("r.h5")});
    const json real = facts_of({"analyze", kTruth, "--observables", "q4", "-o", path("rt.h5")});
    const double minimum = measured(found.at("q4"), "q4_minimum");
    EXPECT_GT(minimum, 0.65);
    EXPECT_LT(minimum, 0.80);
    // Bins of the histogram are .01 wide; errors of .016 a in the bonds move the minimum by one or
    // two.
    EXPECT_NEAR(minimum, measured(real.at("q4"), "q4_minimum"), 0.02);
}

}  // namespace
}  // namespace grainfield
