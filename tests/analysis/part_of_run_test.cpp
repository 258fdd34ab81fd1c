#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/analysis.h"
#include "analysis/density/number_variance.h"
#include "analysis/pairs/pair_distribution.h"
#include "analysis/spectra/sk_observable.h"
#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;
using ::testing::HasSubstr;

constexpr int kFrames = 37;  // no multiple of the 16 blocks of time

// A walled gas in pixels, 8 px a diameter.
MemorySource gas() {
    MemorySource source;
    source.description.length_unit = LengthUnit::pixel;
    source.description.diameter = 8;
    RandomStream random(3, "parts");
    for (int f = 0; f < kFrames; ++f) {
        Snapshot s;
        s.frame = f;
        s.time = f;
        s.box = square_box(160, Boundary::walls);
        for (int i = 0; i < 150 + f % 3; ++i) {
            s.position.push_back({160 * random.uniform(), 160 * random.uniform()});
            s.z.push_back(4 + 8 * random.uniform());
        }
        source.snapshots.push_back(std::move(s));
    }
    return source;
}

AnalysisOptions options() {
    AnalysisOptions options;
    options.observables = {"sk", "s4", "variance", "fit", "synthetic", "gr", "height"};
    options.of<ListedWavevectors>().k = {{0.3, 0.1}, {1.2, -0.4}};
    options.of<NumberVarianceOptions>().largest = 10;
    return options;
}

std::vector<Checkpoint> parts_of(const MemorySource& source, const std::vector<int>& cuts) {
    std::vector<Checkpoint> parts;
    int first = 0;
    for (const int end : cuts) {
        MemorySource part = source;
        part.snapshots.assign(source.snapshots.begin() + first, source.snapshots.begin() + end);
        parts.push_back(measure_part(part, {first, kFrames}, options()));
        first = end;
    }
    return parts;
}

Results merge(const std::vector<Checkpoint>& parts) {
    std::size_t next = 0;
    return merged(
        [&]() { return next < parts.size() ? std::optional(parts[next++]) : std::nullopt; },
        options());
}

// Sums are added in another order: some hundred roundings, and differences of like numbers.
void expect_near(double a, double b, const std::string& what) {
    if (std::isnan(a) && std::isnan(b)) return;
    EXPECT_NEAR(a, b, 1e-8 * std::max(1.0, std::abs(b))) << what;
}

void expect_same(const ObservableResult& a, const ObservableResult& b) {
    ASSERT_EQ(a.measurements.size(), b.measurements.size()) << a.name;
    for (std::size_t i = 0; i < a.measurements.size(); ++i) {
        const Measurement& x = a.measurements[i];
        const Measurement& y = b.measurements[i];
        ASSERT_EQ(x.value.has_value(), y.value.has_value()) << a.name << " " << x.name;
        ASSERT_EQ(x.error.has_value(), y.error.has_value()) << a.name << " " << x.name;
        if (x.value) expect_near(*x.value, *y.value, a.name + " " + x.name);
        if (x.error) expect_near(*x.error, *y.error, a.name + " error of " + x.name);
        EXPECT_EQ(x.reason, y.reason);
    }
    ASSERT_EQ(a.curves.size(), b.curves.size()) << a.name;
    for (std::size_t c = 0; c < a.curves.size(); ++c) {
        ASSERT_EQ(a.curves[c].columns.size(), b.curves[c].columns.size());
        for (std::size_t i = 0; i < a.curves[c].columns.size(); ++i) {
            const Column& x = a.curves[c].columns[i];
            const Column& y = b.curves[c].columns[i];
            ASSERT_EQ(x.values.size(), y.values.size()) << a.curves[c].name << " " << x.name;
            for (std::size_t k = 0; k < x.values.size(); ++k) {
                expect_near(x.values[k], y.values[k], a.curves[c].name + " " + x.name);
            }
        }
    }
}

TEST(PartOfRun, MergedPartsGiveValuesAndErrorsOfTheWhole) {
    MemorySource source = gas();
    const Results whole = measure(source, options());
    // A part of one snapshot, seams within blocks of time.
    const Results together = merge(parts_of(source, {13, 14, 30, kFrames}));
    EXPECT_EQ(together.frames, kFrames);
    EXPECT_NEAR(together.particles_mean, whole.particles_mean, 1e-9);
    EXPECT_EQ(together.box, whole.box);
    EXPECT_EQ(together.source.diameter, 8);
    ASSERT_EQ(together.observables.size(), whole.observables.size());
    for (std::size_t i = 0; i < whole.observables.size(); ++i) {
        expect_same(together.observables[i], whole.observables[i]);
    }
}

// g(r) of five frames of 37: each seventh of the whole, in whatever parts it comes.
TEST(PartOfRun, ObservablesOfSomeFramesTakeTheSameOnesInParts) {
    MemorySource source = gas();
    AnalysisOptions few = options();
    few.observables = {"gr"};
    few.of<PairDistributionOptions>().frames = 5;
    const Results whole = measure(source, few);
    std::vector<Checkpoint> parts;
    for (const auto& [first, end] : {std::pair{0, 13}, std::pair{13, 30}, std::pair{30, kFrames}}) {
        MemorySource part = source;
        part.snapshots.assign(source.snapshots.begin() + first, source.snapshots.begin() + end);
        parts.push_back(measure_part(part, {first, kFrames}, few));
    }
    std::size_t next = 0;
    const Results together = merged(
        [&]() { return next < parts.size() ? std::optional(parts[next++]) : std::nullopt; }, few);
    expect_same(together.observables.at(0), whole.observables.at(0));
}

TEST(PartOfRun, WhatFollowsParticlesIsLeftOutWithAWarning) {
    MemorySource source = gas();
    RunPlan plan;
    AnalysisOptions all;
    all.of<NumberVarianceOptions>().largest = 10;
    const Checkpoint part = measure_part(source, {}, all, {.plan = &plan});
    EXPECT_EQ(part.texts.at("observables"), options().observables);
    ASSERT_FALSE(plan.warnings().empty());
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("left out: q4, phase, msd"));
    all.observables = {"msd"};
    EXPECT_THROW(measure_part(source, {}, all), OptionError);
}

TEST(PartOfRun, PartsThatDoNotFitAreRefused) {
    const MemorySource source = gas();
    const std::vector<Checkpoint> parts = parts_of(source, {20, kFrames});
    EXPECT_THROW(merge({parts[1], parts[0]}), InputError) << "not in order";
    EXPECT_THROW(merge({parts[0], parts[0]}), InputError) << "twice";
    EXPECT_THROW(merge({}), InputError);
    Checkpoint other = parts[1];
    other.reals["diameter"] = {9};
    EXPECT_THROW(merge({parts[0], other}), InputError);
    other = parts[1];
    other.integers["variance/counts"].pop_back();
    EXPECT_THROW(merge({parts[0], other}), InputError);
    other = parts[1];
    other.kind = "md";
    EXPECT_THROW(merge({parts[0], other}), InputError);
}

TEST(PartOfRun, PartsWithNonsenseAreRefused) {
    const MemorySource source = gas();
    const std::vector<Checkpoint> parts = parts_of(source, {20, kFrames});
    const auto expect_refused = [&](const std::string& name, auto&& change) {
        Checkpoint bad = parts[0];
        change(bad);
        EXPECT_THROW(merge({bad}), InputError) << name;
    };
    using C = Checkpoint;
    const auto far = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t number : {std::int64_t{-1}, std::int64_t{77}, far}) {
        expect_refused("origin", [&](C& c) { c.integers["info"][0] = number; });
        expect_refused("time unit", [&](C& c) { c.integers["info"][2] = number; });
        expect_refused("boundary", [&](C& c) { c.integers["box"][1] = number; });
    }
    for (const double length : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
        expect_refused("diameter", [&](C& c) { c.reals["diameter"] = {length}; });
        expect_refused("box", [&](C& c) { c.reals["box"][2] = length; });
    }
    expect_refused("frames", [&](C& c) { c.integers["part"][2] = far; });
    expect_refused("first", [&](C& c) { c.integers["part"][0] = far; });
}

}  // namespace
}  // namespace grainfield::analysis
