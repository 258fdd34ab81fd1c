#include "analysis/motion/height_series.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

double value(const ObservableResult& r, const char* name) {
    const Measurement* m = r.find_measurement(name);
    return m != nullptr && m->value ? *m->value : std::nan("");
}

std::string reason(const ObservableResult& r, const char* name) {
    return r.find_measurement(name)->reason;
}

struct Vibration {
    double frequency = 80;
    double rate = 500;
    double amplitude = 0.05;
    double phase = 0.3;
    double noise = 0.004;  // of the mean of a frame
};

// Layers of 200 spheres, all moved alike.
ObservableResult heights_of(const Vibration& v, int frames, bool is_known) {
    RandomStream random(7, "heights");
    TrajectoryInfo info;
    if (is_known) info.vibration_frequency = v.frequency;
    HeightSeries series(info);
    for (int f = 0; f < frames; ++f) {
        Pattern layer;
        layer.frame = f;
        layer.time = f / v.rate;
        const double shift =
            v.amplitude * std::sin(2 * std::numbers::pi * (v.frequency * layer.time + v.phase)) +
            v.noise * random.normal();
        for (int i = 0; i < 200; ++i) {
            layer.position.push_back({0.1 * i, 0});
            layer.z.push_back(0.5 + 0.94 * (i + 0.5) / 200 + shift);
        }
        series.add(HeightSeries::measure(layer));
    }
    return series.result();
}

// False alarms: three values at 6 standard errors.
TEST(HeightSeries, FindsAmplitudeAndPhaseOfAVibrationThatIsKnown) {
    const ObservableResult r = heights_of({}, 300, true);
    const double error = 0.004 * std::sqrt(2.0 / 300);
    EXPECT_NEAR(value(r, "height_amplitude"), 0.05, 6 * error);
    EXPECT_NEAR(value(r, "height_phase"), 0.3, 6 * error / (2 * std::numbers::pi * 0.05));
    EXPECT_EQ(value(r, "height_frequency"), 80);
    EXPECT_NEAR(*r.find_measurement("height_amplitude")->error, error, 0.2 * error);
    EXPECT_NEAR(value(r, "height_mean"), 0.97, 0.005);
}

TEST(HeightSeries, SearchesAFrequencyThatIsNotKnown) {
    const ObservableResult r = heights_of({}, 300, false);
    EXPECT_NEAR(value(r, "height_frequency"), 80, 0.3);  // the resolution is 1.7
    EXPECT_NEAR(value(r, "height_amplitude"), 0.05, 0.004);
}

TEST(HeightSeries, FramesAtOnePhaseShowNoMotion) {
    const ObservableResult r = heights_of({.rate = 80}, 100, true);
    EXPECT_NE(reason(r, "height_amplitude").find("phases"), std::string::npos);
}

TEST(HeightSeries, NoiseIsNoMotion) {
    const ObservableResult r = heights_of({.amplitude = 0}, 300, true);
    EXPECT_NE(reason(r, "height_amplitude").find("errors"), std::string::npos);
    const ObservableResult searched = heights_of({.amplitude = 0}, 300, false);
    EXPECT_FALSE(searched.find_measurement("height_amplitude")->value);
}

TEST(HeightSeries, AFewFramesShowNoMotion) {
    const ObservableResult r = heights_of({}, 7, true);
    EXPECT_NE(reason(r, "height_amplitude").find("8 are needed"), std::string::npos);
}

TEST(HeightSeries, TheProfileHasTheAreaOneAndTheSpreadOfTheHeights) {
    const ObservableResult r = heights_of({.amplitude = 0, .noise = 0}, 4, true);
    const Curve* profile = r.find_curve("height_profile");
    double area = 0;
    for (const double density : profile->find("density")->values) area += 0.02 * density;
    EXPECT_NEAR(area, 1, 1e-12);
    EXPECT_NEAR(value(r, "height_spread"), 0.94 / std::sqrt(12.0), 1e-3);
    EXPECT_NEAR(profile->find("z")->values.front(), 0.51, 1e-9);
    EXPECT_NEAR(r.find_curve("height")->find("low")->values[0], 0.5 + 0.05 * 0.94, 0.005);
}

TEST(HeightSeries, WithoutHeightsHasAReason) {
    HeightSeries series(TrajectoryInfo{});
    Pattern flat;
    flat.position = {{0, 0}};
    series.add(HeightSeries::measure(flat));
    EXPECT_NE(series.result().reason.find("heights"), std::string::npos);
}

TEST(HeightSeries, UnknownHeightsOfAFrameAreLeftOut) {
    HeightSeries series(TrajectoryInfo{});
    Pattern layer;
    layer.position = {{0, 0}, {1, 0}, {2, 0}};
    layer.z = {0.5, std::nan(""), 0.7};
    series.add(HeightSeries::measure(layer));
    const ObservableResult r = series.result();
    EXPECT_NEAR(value(r, "height_mean"), 0.6, 1e-12);
    EXPECT_EQ(r.find_curve("height")->find("n")->values[0], 2);
}

}  // namespace
}  // namespace grainfield::analysis
