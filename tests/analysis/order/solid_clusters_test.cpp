#include "analysis/order/solid_clusters.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

// Particles in a row, neighbours of the next ones.
BondOrderField chain(std::size_t n) {
    BondOrderField field;
    for (std::size_t i = 0; i < n; ++i) {
        field.first.push_back(field.neighbour.size());
        int count = 0;
        if (i > 0) field.neighbour.push_back(static_cast<int>(i) - 1), ++count;
        if (i + 1 < n) field.neighbour.push_back(static_cast<int>(i) + 1), ++count;
        field.neighbours.push_back(count);
    }
    return field;
}

SolidClusters::Frame frame(const BondOrderField& field, const std::string& solid, double time) {
    SolidClusters::Frame f;
    for (std::size_t i = 0; i < solid.size(); ++i) {
        f.id.push_back(static_cast<std::int64_t>(i) * 3);
        f.solid.push_back(solid[i] == 'x');
    }
    f.field = &field;
    f.time = time;
    return f;
}

TEST(SolidClusters, AreSolidNeighboursJoined) {
    const BondOrderField field = chain(12);
    SolidClusters clusters(false);
    clusters.add(frame(field, "xx.xxx.x....", 0));
    clusters.add(frame(field, "xxxxx.......", 1));
    ObservableResult result;
    clusters.add_to(result);
    const Curve* curve = result.find_curve("clusters");
    // Sizes 1; 2 and 3; 5, in two windows.
    EXPECT_EQ(curve->find("clusters")->values, (std::vector<double>{0.5, 1, 0.5}));
    EXPECT_DOUBLE_EQ(*result.find_measurement("largest_cluster")->value, 4);
    EXPECT_DOUBLE_EQ(*result.find_measurement("cluster_size")->value, 0.5 * (14.0 / 6 + 5));
    EXPECT_THAT(result.find_measurement("cluster_lifetime")->reason, testing::HasSubstr("alone"));
}

// A cluster that melts at a constant rate and is seen at the ends of windows only: τ to 6 standard
// errors, whether it lives long or dies in the window with probability one half.
TEST(SolidClusters, LiveAsLongAsTheyDo) {
    const BondOrderField field = chain(10);
    for (const double lifetime : {4.0, 0.4 / std::numbers::ln2}) {
        SolidClusters clusters(true);
        RandomStream random(1, "lives");
        bool solid = false;
        for (int w = 0; w < 20000; ++w) {
            const double life = -lifetime * std::log(1 - random.uniform());  // of what is there
            solid = solid ? life > 0.4 : true;
            clusters.add(frame(field, solid ? "xxxxxxxxx." : "..........", 0.4 * w));
        }
        ObservableResult result;
        clusters.add_to(result);
        const Measurement* life = result.find_measurement("cluster_lifetime");
        EXPECT_NEAR(*life->value, lifetime, 6 * *life->error);
        EXPECT_LT(*life->error, 0.03 * lifetime);
    }
}

TEST(SolidClusters, OfTwoThatMergeTheLargerLivesOn) {
    const BondOrderField field = chain(30);
    SolidClusters clusters(true);
    clusters.add(frame(field, "xxxxxxxxxx.xxxxxxxxx..........", 0));  // ten and nine
    clusters.add(frame(field, "xxxxxxxxxxxxxxxxxxxx..........", 1));
    clusters.add(frame(field, "xxxxxxxxxxxxxxxxxxxx..........", 2));
    ObservableResult result;
    clusters.add_to(result);
    const Measurement* life = result.find_measurement("cluster_lifetime");
    // Two at risk in the first step, one in the second; one death.
    EXPECT_NEAR(*life->value, 1 / std::log(1.5), 1e-12);
    EXPECT_FALSE(life->error.has_value());
}

TEST(SolidClusters, OfTwoMergedHalvesAreThoseOfTheWhole) {
    const BondOrderField field = chain(60);
    SolidClusters whole(true), first(true), second(true);
    RandomStream random(2, "halves");
    std::string solid(60, 'x');
    for (int w = 0; w < 40; ++w) {
        for (std::size_t i = 0; i < solid.size(); ++i) {
            if (random.uniform() < (solid[i] == 'x' ? 0.02 : 0.2)) {
                solid[i] = solid[i] == 'x' ? '.' : 'x';
            }
        }
        whole.add(frame(field, solid, 0.4 * w));
        (w < 20 ? first : second).add(frame(field, solid, 0.4 * w));
    }
    first.merge(second);
    first.merge(SolidClusters(true));  // nothing
    ObservableResult a, b;
    whole.add_to(a);
    first.add_to(b);
    const Measurement* life = a.find_measurement("cluster_lifetime");
    ASSERT_TRUE(life->error.has_value()) << life->reason;
    ASSERT_EQ(a.measurements.size(), b.measurements.size());
    for (std::size_t i = 0; i < a.measurements.size(); ++i) {
        EXPECT_NEAR(*a.measurements[i].value, *b.measurements[i].value, 1e-12);
        EXPECT_NEAR(*a.measurements[i].error, *b.measurements[i].error, 1e-12);
    }
    const Curve* sizes = a.find_curve("clusters");
    EXPECT_EQ(sizes->find("clusters")->values, b.find_curve("clusters")->find("clusters")->values);
}

TEST(SolidClusters, LeaveOutShortWindowsAlsoWhenMerged) {
    const BondOrderField field = chain(20);
    const auto window = [&](const char* solid, double time, double frames) {
        SolidClusters::Frame f = frame(field, solid, time);
        f.frames = frames;
        return f;
    };
    const char* cluster = "xxxxxxxxxx..........";
    const char* none = "....................";
    SolidClusters first(true), second(true);
    for (SolidClusters* part : {&first, &second}) {
        const double start = part == &first ? 0 : 3;
        part->add(window(cluster, start, 4));
        part->add(window(cluster, start + 1, 4));
        part->add(window("xxxxxxxxxxxxxxxxxxxx", start + 2, 1));
    }
    second.add(window(none, 6, 1));
    first.merge(second);
    ObservableResult all, counted;
    first.add_to(all);
    first.add_to(counted, {2});
    EXPECT_DOUBLE_EQ(*all.find_measurement("largest_cluster")->value, 80.0 / 7);
    EXPECT_DOUBLE_EQ(*counted.find_measurement("largest_cluster")->value, 10);
    EXPECT_DOUBLE_EQ(*counted.find_measurement("cluster_size")->value, 10);
    EXPECT_EQ(counted.find_curve("clusters")->find("clusters")->values,
              (std::vector<double>{0, 0, 0, 1}));
    EXPECT_TRUE(all.find_measurement("cluster_lifetime")->value.has_value());
    EXPECT_THAT(counted.find_measurement("cluster_lifetime")->reason,
                testing::HasSubstr("no cluster of 8 particles died: longer than 2"));
}

TEST(SolidClusters, ThatAllOutliveTheRunHaveAReason) {
    const BondOrderField field = chain(20);
    SolidClusters clusters(true);
    for (int w = 0; w < 5; ++w) clusters.add(frame(field, "xxxxxxxxxxxxxxx.....", w));
    ObservableResult result;
    clusters.add_to(result);
    EXPECT_THAT(result.find_measurement("cluster_lifetime")->reason, testing::HasSubstr("died"));
    SolidClusters none(true);
    none.add(frame(field, "....................", 0));
    ObservableResult empty;
    none.add_to(empty);
    EXPECT_EQ(*empty.find_measurement("largest_cluster")->value, 0);
    EXPECT_FALSE(empty.find_measurement("cluster_lifetime")->value.has_value());
}

}  // namespace
}  // namespace grainfield::analysis
