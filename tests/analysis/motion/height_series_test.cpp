#include "analysis/motion/height_series.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/errors.h"
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
    double begin = 0;      // time of the first frame
    double drift = 0;      // from the first frame to the last
    std::uint64_t seed = 7;
};

// Layers of 20 spheres, all moved alike.
ObservableResult heights_of(const Vibration& v, int frames, bool is_known) {
    RandomStream random(v.seed, "heights");
    TrajectoryInfo info;
    if (is_known) info.vibration_frequency = v.frequency;
    HeightSeries series(info);
    for (int f = 0; f < frames; ++f) {
        Pattern layer;
        layer.frame = f;
        layer.time = v.begin + f / v.rate;
        const double shift =
            v.amplitude * std::sin(2 * std::numbers::pi * (v.frequency * layer.time + v.phase)) +
            v.noise * random.normal() + v.drift * f / frames;
        for (int i = 0; i < 20; ++i) {
            layer.position.push_back({0.1 * i, 0});
            layer.z.push_back(0.5 + 0.94 * (i + 0.5) / 20 + shift);
        }
        series.add(HeightSeries::measure(layer));
    }
    return series.result();
}

// Of a turn, between −1/2 and 1/2.
double turns(double difference) {
    return difference - std::round(difference);
}

// False alarms: three values at 6 standard errors.
TEST(HeightSeries, FindsAmplitudeAndPhaseOfAVibrationThatIsKnown) {
    const ObservableResult r = heights_of({}, 300, true);
    const double error = 0.004 * std::sqrt(2.0 / 300);
    EXPECT_NEAR(value(r, "height_amplitude"), 0.05, 6 * error);
    EXPECT_NEAR(value(r, "height_phase"), 0.3, 6 * error / (2 * std::numbers::pi * 0.05));
    EXPECT_EQ(value(r, "height_frequency"), 80);
    EXPECT_NEAR(*r.find_measurement("height_amplitude")->error, error, 0.2 * error);
    EXPECT_NEAR(value(r, "height_mean"), 0.97, 6 * 0.004 / std::sqrt(300.0));
}

// Three values of four series at 6 of the errors that are stated.
TEST(HeightSeries, FindsAVibrationThatIsNotKnownWithinItsErrors) {
    for (const double begin : {0.0, 100.0}) {
        for (const int frames : {300, 8000}) {
            const ObservableResult r = heights_of({.begin = begin}, frames, false);
            const auto error = [&](const char* name) { return *r.find_measurement(name)->error; };
            EXPECT_NEAR(value(r, "height_frequency"), 80, 6 * error("height_frequency"));
            EXPECT_NEAR(value(r, "height_amplitude"), 0.05, 6 * error("height_amplitude"));
            EXPECT_LT(std::abs(turns(value(r, "height_phase") - 0.3)), 6 * error("height_phase"));
            EXPECT_NEAR(error("height_amplitude"), 0.004 * std::sqrt(2.0 / frames),
                        0.2 * 0.004 * std::sqrt(2.0 / frames));
            EXPECT_LT(error("height_frequency"), 0.1 * 500.0 / frames);
        }
    }
}

TEST(HeightSeries, FramesAtOnePhaseShowNoMotion) {
    const ObservableResult r = heights_of({.rate = 80}, 100, true);
    EXPECT_NE(reason(r, "height_amplitude").find("phases"), std::string::npos);
}

// Each of 60 series has a chance of 1e-6 or less to be taken for a vibration.
TEST(HeightSeries, NoiseIsNoMotionNotEvenNearOnePhase) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        for (const Vibration& v : {Vibration{.amplitude = 0, .seed = seed},
                                   Vibration{.rate = 79.9, .amplitude = 0, .seed = seed}}) {
            EXPECT_FALSE(heights_of(v, 300, true).find_measurement("height_amplitude")->value);
        }
        const Vibration quiet{.amplitude = 0, .seed = seed};
        EXPECT_FALSE(heights_of(quiet, 100, false).find_measurement("height_amplitude")->value);
    }
}

TEST(HeightSeries, ADriftIsNoMotion) {
    const ObservableResult r = heights_of({.amplitude = 0, .drift = 0.05}, 300, false);
    EXPECT_FALSE(r.find_measurement("height_amplitude")->value);
}

TEST(HeightSeries, TimesThatStandStillShowNoMotion) {
    const ObservableResult r = heights_of({.rate = INFINITY}, 20, false);
    EXPECT_NE(reason(r, "height_amplitude").find("times"), std::string::npos);
}

TEST(HeightSeries, AFewFramesShowNoMotion) {
    const ObservableResult r = heights_of({}, 11, true);
    EXPECT_NE(reason(r, "height_amplitude").find("11 of the 12"), std::string::npos);
}

TEST(HeightSeries, TheProfileHasTheAreaOneAndTheSpreadOfTheHeights) {
    const ObservableResult r = heights_of({.amplitude = 0, .noise = 0}, 4, true);
    const Curve* profile = r.find_curve("height_profile");
    double area = 0;
    for (const double density : profile->find("density")->values) area += 0.02 * density;
    EXPECT_NEAR(area, 1, 1e-12);
    EXPECT_NEAR(value(r, "height_spread"), 0.94 * std::sqrt((1 - 1.0 / 400) / 12), 1e-9);
    EXPECT_NEAR(profile->find("z")->values.front(), 0.53, 1e-9);
    EXPECT_NEAR(r.find_curve("height")->find("low")->values[0], 0.5 + 0.94 * (0.5 + 0.05 * 19) / 20,
                1e-9);
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

TEST(HeightSeries, SpheresBeyondTheProfileCountInTheSpread) {
    HeightSeries series(TrajectoryInfo{});
    Pattern layer;
    layer.position = {{0, 0}, {1, 0}};
    layer.z = {0, 100};
    series.add(HeightSeries::measure(layer));
    EXPECT_NEAR(value(series.result(), "height_spread"), 50, 1e-9);
}

TEST(HeightSeries, RefusesStoredHeightsThatDoNotFit) {
    HeightSeries series(TrajectoryInfo{});
    Checkpoint stored;
    series.save(stored, "h.");
    stored.reals["h.mean"] = {1};
    EXPECT_THROW(series.restore(stored, "h."), InputError);
    stored.reals.erase("h.low");
    EXPECT_THROW(series.restore(stored, "h."), InputError);
}

}  // namespace
}  // namespace grainfield::analysis
