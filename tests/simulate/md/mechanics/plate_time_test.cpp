#include "simulate/md/mechanics/plate_time.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {

namespace {

MdSystem vibrating(double amplitude, double omega, double height) {
    MdSystem system;
    system.amplitude = amplitude;
    system.angular_frequency = omega;
    system.length.z = height;
    return system;
}

// Gap to the low (+1) or high (−1) plate in extended precision.
long double gap(const MdSystem& s, const Grain& g, long double t, int side) {
    const long double tau = t - g.t;
    const long double z = g.r.z + g.v.z * tau - s.gravity * tau * tau / 2;
    const long double plate = s.amplitude * sinl(static_cast<long double>(s.angular_frequency) * t);
    return side > 0 ? z - 0.5L - plate : s.length.z + plate - z - 0.5L;
}

}  // namespace

// Sampling at 1e-4 of the period misses only roots of which the gap is below ~1e-8 between.
TEST(PlateTime, FindsTheFirstContactWithEitherPlate) {
    RandomStream random(1, "plates");
    for (int i = 0; i < 3000; ++i) {
        const MdSystem s =
            vibrating(random.uniform(0.01, 0.3), random.uniform(1, 10), random.uniform(1.5, 2.5));
        const PlateSolver solver(s);
        Grain g;
        g.t = random.uniform(0, 2);
        const double plate = s.amplitude * std::sin(s.angular_frequency * g.t);
        g.r.z = 0.5 + plate + random.uniform() * (s.length.z - 1);
        g.v.z = random.normal();
        const auto hit = solver.first_hit<Plates::vibrating, true>(g, g.t + 5);
        const double end = std::min(hit.time, g.t + 5);
        const double step = 1e-4 * s.period();
        for (double t = g.t; t < end; t += step) {
            ASSERT_GT(gap(s, g, t, +1), -1e-14L) << i;
            ASSERT_GT(gap(s, g, t, -1), -1e-14L) << i;
        }
        if (hit.time < g.t + 5) {
            ASSERT_LT(std::abs(gap(s, g, hit.time, hit.high ? -1 : +1)), 3e-15L);
        }
    }
}

// Where the plate throws as hard as gravity pulls, gap, rate and curvature vanish together.
TEST(PlateTime, FindsTheFirstContactOfTinyHopsAtTheOnsetOfFlight) {
    RandomStream random(4, "plates");
    for (int i = 0; i < 300; ++i) {
        const double excess = std::pow(10.0, random.uniform(-6, 0));
        const MdSystem s = vibrating((1 + excess) / 25, 5, 1e3);
        const PlateSolver solver(s);
        Grain g;
        g.t = (std::numbers::pi / 2 + 0.3 * random.normal()) / 5 + 2;
        g.r.z = 0.5 + s.amplitude * std::sin(5 * g.t) + std::pow(10.0, random.uniform(-9, -4));
        g.v.z = 5 * s.amplitude * std::cos(5 * g.t) + std::pow(10.0, random.uniform(-6, -2));
        const auto hit = solver.first_hit<Plates::vibrating, true>(g, g.t + 5);
        const double end = std::min(hit.time, g.t + 5);
        for (double t = g.t; t < end; t += 1e-3) ASSERT_GT(gap(s, g, t, +1), -1e-14L) << i;
        ASSERT_LT(hit.time, g.t + 5);
        ASSERT_LT(std::abs(gap(s, g, hit.time, +1)), 3e-15L);
    }
}

TEST(PlateTime, DoesNotFindTheSameContactAgain) {
    RandomStream random(2, "plates");
    const MdSystem s = vibrating(0.1, 5, 1.84);
    const PlateSolver solver(s);
    for (int i = 0; i < 20000; ++i) {
        Grain g;
        g.t = random.uniform(0, 1.25);
        const SineCosine plate = sine_cosine(5 * g.t);
        g.r.z = 0.5 + 0.1 * plate.sine;
        g.v.z = 0.5 * plate.cosine + 1e-6 + random.uniform();  // just bounced
        const auto hit = solver.first_hit<Plates::vibrating, true>(g, 100);
        ASSERT_GT(hit.time, g.t + 1e-9);
    }
}

TEST(PlateTime, CollidesNowWhereAGrainHasEnteredThePlate) {
    const PlateSolver solver(vibrating(0.1, 5, 1.84));
    Grain g;
    g.t = 0.5;
    g.r.z = 0.5 + 0.1 * sine_cosine(2.5).sine - 1e-13;
    g.v.z = -1;
    EXPECT_EQ((solver.first_hit<Plates::vibrating, true>(g, 10).time), 0.5);
}

TEST(PlateTime, PlatesAtRestAreMetInClosedForm) {
    MdSystem s;
    s.length.z = 3;
    const PlateSolver solver(s);
    Grain g;
    g.r.z = 1.5;
    g.v.z = 0;
    const auto fall = solver.first_hit<Plates::at_rest, true>(g, 10);
    EXPECT_NEAR(fall.time, std::sqrt(2.0), 1e-15);
    EXPECT_FALSE(fall.high);
    g.v.z = 2;
    const auto rise = solver.first_hit<Plates::at_rest, true>(g, 10);
    EXPECT_TRUE(rise.high);
    EXPECT_NEAR(rise.time, 2 - std::sqrt(2.0), 1e-15);
    g.v.z = 2;
    const auto straight = solver.first_hit<Plates::at_rest, false>(g, 10);
    EXPECT_TRUE(straight.high);
    EXPECT_NEAR(straight.time, 0.5, 1e-15);
}

// A single inelastic grain on a floor at rest: flight times shrink by e at each bounce.
TEST(PlateTime, FlightTimesOfABouncingGrainAreGeometric) {
    MdSystem s;
    s.length.z = 10;
    const PlateSolver solver(s);
    Grain g;
    g.r.z = 0.5;
    g.v.z = 1;
    const double e = 0.8;
    double expected = 2;
    for (int bounce = 0; bounce < 40; ++bounce) {
        const double t = solver.first_hit<Plates::at_rest, true>(g, 100).time;
        EXPECT_NEAR((t - g.t) / expected, 1, 1e-11) << bounce;
        fly(g.r, g.v, t - g.t, 1);
        g.t = t;
        g.v.z *= -e;
        expected *= e;
    }
}

}  // namespace grainfield::simulate
