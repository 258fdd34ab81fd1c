#include "report/maps/particle_map.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

std::vector<std::uint8_t> decode_base64(const std::string& text) {
    std::vector<std::uint8_t> bytes;
    std::uint32_t word = 0;
    int bits = 0;
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (char c : text) {
        if (c == '=') break;
        word = word << 6U | static_cast<std::uint32_t>(digits.find(c));
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes.push_back(static_cast<std::uint8_t>(word >> static_cast<unsigned>(bits) & 255U));
    }
    return bytes;
}

TEST(ParticleMap, CarriesPositionsToAFortiethOfADisc) {
    const std::vector<Results> runs{sample::results({1, 300, 80, true, "A"})};
    const auto maps = make_maps(runs, {});
    ASSERT_EQ(maps.size(), 1U);
    const auto page = nlohmann::json::parse(map_json(maps[0]));
    const auto bytes = decode_base64(page["points"]);
    const auto order = decode_base64(page["order"]);
    const std::vector<Vec2>& truth = runs[0].previews[0].snapshot.position;
    ASSERT_EQ(bytes.size(), 4 * truth.size());
    ASSERT_EQ(order.size(), truth.size());
    EXPECT_EQ(order[0], 255) << "undefined |Q4|";
    const auto coordinate = [&](const char* axis, std::size_t at) {
        const double low = page[axis][0];
        const double high = page[axis][1];
        return low + (high - low) * (bytes[at] + 256 * bytes[at + 1]) / 65535;
    };
    const double step = (300 + 10.09) / 65535;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_NEAR(coordinate("pointsX", 4 * i), truth[i].x, 0.51 * step);
        EXPECT_NEAR(coordinate("pointsY", 4 * i + 2), truth[i].y, 0.51 * step);
        if (i > 0) {
            EXPECT_NEAR(order[i] / 254.0, runs[0].previews[0].abs_q4[i], 0.51 / 254);
        }
    }
    EXPECT_EQ(page["yDown"], true);
    EXPECT_EQ(page["x"], nlohmann::json::parse("[-0.5, 299.5]"));
}

TEST(ParticleMap, OfARegionHasAxesInPixelsOfTheWholeFrame) {
    std::vector<Results> runs{sample::results({1, 300, 80, true, "A"})};
    Snapshot& snapshot = runs[0].previews[0].snapshot;
    for (Vec2& p : snapshot.position) p += Vec2{40, 25};
    snapshot.box = {{39.5, 24.5}, {300, 300}, {}, 0};
    const auto maps = make_maps(runs, {});
    const auto page = nlohmann::json::parse(map_json(maps[0]));
    EXPECT_EQ(page["x"], nlohmann::json::parse("[39.5, 339.5]"));
    EXPECT_EQ(page["y"], nlohmann::json::parse("[24.5, 324.5]"));
}

TEST(ParticleMap, OfASimulationHasNoImageAndYUpwards) {
    Results run;
    run.source.length_unit = LengthUnit::diameter;
    run.previews.resize(1);
    run.previews[0].snapshot.box = {{0, 0}, {20, 10}, {}, 0};
    run.previews[0].snapshot.position = {{1, 2}, {3, 4}};
    const auto maps = make_maps({run}, {});
    ASSERT_EQ(maps.size(), 1U);
    EXPECT_TRUE(maps[0].png.empty());
    EXPECT_FALSE(maps[0].y_down);
    EXPECT_EQ(maps[0].unit, "a");
    EXPECT_EQ(maps[0].x, (std::array{0.0, 20.0}));
    EXPECT_EQ(nlohmann::json::parse(map_json(maps[0]))["image"], "");
}

TEST(ParticleMap, WithoutBoxOrImageSpansItsParticles) {
    Results run;
    run.source.length_unit = LengthUnit::diameter;
    run.source.diameter = std::nan("");
    run.previews.resize(1);
    run.previews[0].snapshot.position = {{1, 2}, {5, 9}};
    const auto maps = make_maps({run}, {});
    ASSERT_EQ(maps.size(), 1U);
    EXPECT_EQ(maps[0].x, (std::array{0.5, 5.5}));
    EXPECT_EQ(maps[0].y, (std::array{1.5, 9.5}));
}

TEST(ParticleMap, LeavesOutPreviewsThatContradictThemselves) {
    Results run = sample::results({1, 100, 30, true, "A"});
    run.previews.resize(4, run.previews[0]);
    run.previews[1].abs_q4.pop_back();
    run.previews[2].snapshot.position[0].x = std::nan("");
    run.previews[3] = {};
    EXPECT_EQ(make_maps({run}, {}).size(), 1U);
}

TEST(ParticleMap, SpreadsPreviewsOverARunAndSharesThemAmongRuns) {
    Results run;
    run.previews.resize(10);
    for (std::size_t i = 0; i < 10; ++i) {
        run.previews[i].snapshot.frame = static_cast<std::int64_t>(i);
        run.previews[i].snapshot.position = {{1, 1}};
    }
    const auto maps = make_maps({run, run}, {8, 1'000'000});
    ASSERT_EQ(maps.size(), 8U);
    std::vector<std::int64_t> frames;
    for (std::size_t i = 0; i < 4; ++i) frames.push_back(maps[i].frame);
    EXPECT_THAT(frames, testing::ElementsAre(0, 3, 6, 9));
    EXPECT_EQ(maps[4].run, 1U);
    EXPECT_EQ(make_maps(std::vector<Results>(30, run), {8, 1'000'000}).size(), 30U)
        << "at least one each";
}

TEST(ParticleMap, ReducesImagesToTheBudgetAndSaysSo) {
    const std::vector<Results> runs{sample::results({1, 300, 80, true, "A"})};
    const std::size_t whole = make_maps(runs, {})[0].png.size();
    const auto maps = make_maps(runs, {24, whole / 3});
    EXPECT_LE(maps[0].png.size(), whole / 3);
    EXPECT_GT(maps[0].reduction, 1);
    EXPECT_THAT(maps[0].title, testing::HasSubstr("image reduced 2×"));
    EXPECT_EQ(maps[0].image_size[0], 300);
}

TEST(ParticleMap, CsvHasARowAParticleAndEmptyCellsForUndefined) {
    Results run;
    run.previews.resize(1);
    run.previews[0].snapshot.frame = 7;
    run.previews[0].snapshot.position = {{1, 2}, {3.5, 4}};
    run.previews[0].snapshot.id = {12, 9};
    run.previews[0].abs_q4 = {0.25, std::nan("")};
    EXPECT_EQ(map_csv(make_maps({run}, {})[0]),
              "frame,particle,x,y,abs_q4\n7,12,1.000,2.000,0.25\n7,9,3.500,4.000,\n");
}

// Three spheres between plates: one on the low plate, one of unknown height, one at the high plate.
Results layer_with_heights() {
    Results run;
    run.source.length_unit = LengthUnit::pixel;
    run.source.diameter = 10;
    run.previews.resize(1);
    Snapshot& snapshot = run.previews[0].snapshot;
    snapshot.box = {{0, 0}, {100, 100}, {}, 18.4};
    snapshot.position = {{10, 20}, {30, 40}, {50, 60}};
    snapshot.z = {5, std::nan(""), 13.4};
    snapshot.z_error = {0.5, 80, std::nan("")};
    return run;
}

TEST(ParticleMap, CarriesHeightsToAThousandthOfAPixelAndTheirErrors) {
    const auto maps = make_maps({layer_with_heights()}, {});
    ASSERT_EQ(maps.size(), 1U);
    EXPECT_TRUE(maps[0].has_heights());
    const auto page = nlohmann::json::parse(map_json(maps[0]));
    const auto steps = decode_base64(page["z"]);
    const auto errors = decode_base64(page["zErrors"]);
    ASSERT_EQ(steps.size(), 6U);
    const double low = page["zRange"][0];
    const double high = page["zRange"][1];
    const auto step = [&](std::size_t i) { return steps[2 * i] + 256 * steps[2 * i + 1]; };
    EXPECT_NEAR(low + (high - low) * step(0) / 65534, 5, 1e-3);
    EXPECT_EQ(step(1), 65535) << "unknown";
    EXPECT_NEAR(low + (high - low) * step(2) / 65534, 13.4, 1e-3);
    EXPECT_THAT(errors, testing::ElementsAre(5, 254, 255)) << "hundredths of a diameter";
    EXPECT_EQ(page["height"], 18.4);
}

TEST(ParticleMap, OfSpheresAtOneHeightHasThatHeight) {
    Results run = layer_with_heights();
    run.previews[0].snapshot.z = {5, 5, 5};
    run.previews[0].snapshot.z_error.clear();
    const auto page = nlohmann::json::parse(map_json(make_maps({run}, {})[0]));
    EXPECT_EQ(page["zRange"][0], 5);
    EXPECT_THAT(decode_base64(page["z"]), testing::Each(0));
    EXPECT_EQ(page["zErrors"], "") << "heights are exact";
}

TEST(ParticleMap, SaysNothingOfHeightsWhereNoneIsKnown) {
    Results run = layer_with_heights();
    for (double& z : run.previews[0].snapshot.z) z = std::nan("");
    const auto maps = make_maps({run}, {});
    EXPECT_FALSE(maps[0].has_heights());
    const auto page = nlohmann::json::parse(map_json(maps[0]));
    for (const char* key : {"z", "zRange", "zErrors", "height"}) {
        EXPECT_FALSE(page.contains(key)) << key;
    }
    EXPECT_THAT(map_csv(maps[0]), testing::StartsWith("frame,particle,x,y,abs_q4\n"));
}

TEST(ParticleMap, CsvHasHeightsOnlyWhereTheyAreKnown) {
    EXPECT_EQ(map_csv(make_maps({layer_with_heights()}, {})[0]),
              "frame,particle,x,y,z,abs_q4\n0,0,10.000,20.000,5,\n0,1,30.000,40.000,,\n"
              "0,2,50.000,60.000,13.4,\n");
}

}  // namespace
}  // namespace grainfield::report
