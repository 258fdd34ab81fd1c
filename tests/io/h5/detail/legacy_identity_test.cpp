#include "io/h5/detail/legacy_identity.h"

#include <gtest/gtest.h>

#include "io/h5/detail/run_record_json.h"

namespace grainfield::io {
namespace {

// As version 0.1 wrote it (shortened: options that nobody asks for are left out).
constexpr const char* md_record = R"({
    "command": "simulate md", "version": "0.1.0", "seed": 1, "threads": 1, "seconds": 2.5,
    "configuration": [["output", "md.h5"], ["cell.gravity", "1"], ["vibration.amplitude", "0.09"],
                      ["vibration.angular-frequency", "5"], ["run.periods", "10"]],
    "inputs": [], "skipped": ["rotation: friction is zero"],
    "warnings": ["incomplete: what was sampled before it failed, in or after period 3 of 10: x",
                 "the layer melts"]})";
constexpr const char* track_record = R"({
    "command": "track", "version": "0.1.0", "seed": 1, "threads": 1, "seconds": 2.5,
    "configuration": [["output", "tracks.h5"], ["track.sphere-diameter", "auto"]],
    "inputs": [["name", "a.tif"]], "skipped": [],
    "warnings": ["lengths are in apparent disc diameters D = 9.000 px; give --sphere-diameter"]})";

RunRecord read(const char* text) {
    nlohmann::json record = parse_json(text, "old.h5");
    record["inputs"] = nlohmann::json::array();
    return record_from_json(record, "old.h5");
}

void set(RunRecord& record, const std::string& option, const std::string& text) {
    for (auto& [name, value] : record.configuration) {
        if (name == option) value = text;
    }
}

TrajectoryInfo info_of(Origin origin, const RunRecord& record) {
    TrajectoryInfo info;
    info.origin = origin;
    add_legacy_identity(info, record);
    return info;
}

Results results_of(Origin origin, const RunRecord& source) {
    Results results;
    results.source.origin = origin;
    results.sources = {source};
    return results;
}

TEST(LegacyIdentity, OfMolecularDynamicsHasGammaFromAmplitudeAndFrequency) {
    const TrajectoryInfo info = info_of(Origin::md, read(md_record));
    ASSERT_TRUE(info.control.has_value());
    EXPECT_EQ(info.control->parameter, ControlParameter::acceleration);
    EXPECT_DOUBLE_EQ(info.control->value, 2.25);
    EXPECT_EQ(info.diameter_origin, DiameterOrigin::simulated);
    EXPECT_EQ(legacy_identity(results_of(Origin::md, read(md_record))), identity_of(info));
}

TEST(LegacyIdentity, TakesGammaFromTheAnalysisBeforeTheSimulation) {
    Results results = results_of(Origin::md, read(md_record));
    results.record.configuration = {{"gamma", "4.5"}};
    EXPECT_DOUBLE_EQ(legacy_identity(results).control.value().value, 4.5);
    results.record.configuration = {{"gamma", "auto"}};
    EXPECT_DOUBLE_EQ(legacy_identity(results).control.value().value, 2.25) << "auto is no number";
}

TEST(LegacyIdentity, WithoutGravityOrWithWordsForNumbersHasNoGamma) {
    RunRecord weightless = read(md_record);
    set(weightless, "cell.gravity", "0");
    EXPECT_FALSE(info_of(Origin::md, weightless).control.has_value());
    RunRecord words = read(md_record);
    set(words, "vibration.angular-frequency", "fast");
    EXPECT_FALSE(info_of(Origin::md, words).control.has_value());
    RunRecord other = read(md_record);
    other.command = "render";
    EXPECT_FALSE(info_of(Origin::rendered, other).control.has_value());
}

TEST(LegacyIdentity, OfAFieldHasNuDimensionAndGradientOrder) {
    RunRecord field;
    field.command = "simulate field";
    field.configuration = {{"lattice.dimension", "1"}, {"model.b", "4"}, {"model.nu", "0.002"}};
    const RunIdentity identity = legacy_field_identity(field);
    EXPECT_EQ(legend_of(identity), "field, 1D, b = 4, ν = 0.002");
    EXPECT_EQ(legacy_identity(results_of(Origin::points, field)), identity);
}

TEST(LegacyIdentity, OfACriticalPointIsTheSeriesThatItsLabelNames) {
    Results results;
    results.observables.emplace_back().name = "critical";
    for (const RunIdentity& series :
         {RunIdentity{.origin = Origin::video}, RunIdentity{.origin = Origin::rendered},
          RunIdentity{.origin = Origin::md},
          RunIdentity{.origin = Origin::field, .gradient_order = 4},
          RunIdentity{.origin = Origin::field, .dimension = 1, .gradient_order = 2}}) {
        results.label = series_text(series);
        RunIdentity critical = series;
        critical.role = RunRole::critical_point;
        EXPECT_EQ(legacy_identity(results), critical) << results.label;
    }
    results.label = "my points";
    EXPECT_EQ(legacy_identity(results), RunIdentity{.role = RunRole::critical_point});
}

TEST(LegacyIdentity, OfTracksSaysWhetherTheDiameterWasGiven) {
    RunRecord track = read(track_record);
    EXPECT_EQ(info_of(Origin::video, track).diameter_origin, DiameterOrigin::apparent);
    set(track, "track.sphere-diameter", "12");
    EXPECT_EQ(info_of(Origin::video, track).diameter_origin, DiameterOrigin::given);
    EXPECT_EQ(info_of(Origin::points, {}).diameter_origin, DiameterOrigin::stated);
}

TEST(LegacyIdentity, WarningsAreKnownByTheirFirstWords) {
    const std::vector<Warning> md = read(md_record).warnings;
    ASSERT_EQ(md.size(), 2U);
    EXPECT_EQ(md[0].code, WarningCode::incomplete);
    EXPECT_EQ(md[1], (Warning{WarningCode::other, "the layer melts"}));
    EXPECT_EQ(read(track_record).warnings.at(0).code, WarningCode::apparent_diameter);
}

}  // namespace
}  // namespace grainfield::io
