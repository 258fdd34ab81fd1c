#include "simulate/md/mechanics/flight.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {

namespace {

Grain grain_at(Vec3 r, Vec3 v, double t) {
    Grain g;
    g.r = r;
    g.v = v;
    g.t = t;
    return g;
}

Vec3 vector_of(RandomStream& random, double width) {
    return {width * random.normal(), width * random.normal(), width * random.normal()};
}

// Squared distance at time t in extended precision.
long double squared_distance(const Grain& a, const Grain& b, long double t, long double g) {
    const auto z = [g](const Grain& x, long double tau) {
        return static_cast<long double>(x.r.z) + x.v.z * tau - g * tau * tau / 2;
    };
    const long double ta = t - a.t;
    const long double tb = t - b.t;
    const long double dx = (b.r.x + b.v.x * tb) - (a.r.x + a.v.x * ta);
    const long double dy = (b.r.y + b.v.y * tb) - (a.r.y + a.v.y * ta);
    const long double dz = z(b, tb) - z(a, ta);
    return dx * dx + dy * dy + dz * dz;
}

}  // namespace

TEST(PairTime, BringsSpheresToContactNotEarlierNotLater) {
    RandomStream random(1, "flight");
    int hits = 0;
    for (int i = 0; i < 200000; ++i) {
        const Grain a = grain_at({}, vector_of(random, 1), random.uniform(0, 0.1));
        const Grain b =
            grain_at(vector_of(random, 1.2), vector_of(random, 1), random.uniform(0, 0.1));
        const double start = std::max(a.t, b.t);
        if (squared_distance(a, b, start, 1) < 1.0001L) continue;
        const double t = pair_time<true>(a, b, {}, 1, 10);
        if (t == never) {
            for (int k = 0; k < 200; ++k) {
                ASSERT_GT(squared_distance(a, b, start + k * (10 - start) / 200, 1), 1 - 1e-12L);
            }
            continue;
        }
        ++hits;
        ASSERT_NEAR(static_cast<double>(squared_distance(a, b, t, 1)), 1, 2e-14 * (1 + t * t));
        for (int k = 0; k < 20; ++k) {
            ASSERT_GT(squared_distance(a, b, start + k * (t - start) / 20, 1), 1 - 1e-13L);
        }
    }
    EXPECT_GT(hits, 10000);
}

TEST(PairTime, IsTheSameBitsWithTheGrainsExchanged) {
    RandomStream random(2, "flight");
    for (int i = 0; i < 200000; ++i) {
        const Grain a =
            grain_at(vector_of(random, 1), vector_of(random, 1), random.uniform(0, 0.1));
        const Grain b =
            grain_at(vector_of(random, 1), vector_of(random, 1), random.uniform(0, 0.1));
        const Vec3 shift{random.uniform() < 0.5 ? 3.0 : 0.0, 0, 0};
        ASSERT_EQ(pair_time<true>(a, b, shift, 1, 10), pair_time<true>(b, a, -1.0 * shift, 1, 10));
    }
}

TEST(PairTime, OverlapCollidesNowWhileApproachingAndNeverWhileReceding) {
    const Grain a = grain_at({}, {}, 0.25);
    const Grain near = grain_at({1 - 1e-15, 0, 0}, {-1, 0, 0}, 0.25);
    const Grain receding = grain_at({1 - 1e-15, 0, 0}, {1, 0, 0}, 0.25);
    EXPECT_EQ(pair_time<false>(a, near, {}, 0, 10), 0.25);
    EXPECT_EQ(pair_time<false>(a, receding, {}, 0, 10), never);
}

TEST(PairTime, GrazingContactsAreFoundToTheSquareRootOfThePrecision) {
    const Grain a = grain_at({}, {}, 0);
    EXPECT_NEAR(pair_time<false>(a, grain_at({2, 1 - 1e-12, 0}, {-1, 0, 0}, 0), {}, 0, 10), 2,
                2e-6);
    EXPECT_EQ(pair_time<false>(a, grain_at({2, 1 + 1e-12, 0}, {-1, 0, 0}, 0), {}, 0, 10), never);
}

TEST(PairTime, DoesNotLookBeyondItsLimit) {
    const Grain a = grain_at({}, {}, 0);
    const Grain b = grain_at({3, 0, 0}, {-1, 0, 0}, 0);
    EXPECT_EQ(pair_time<false>(a, b, {}, 0, 10), 2);
    EXPECT_GE(pair_time<false>(a, b, {}, 0, 1), 1);
}

}  // namespace grainfield::simulate
