#include "simulate/md/mechanics/collision_rule.h"

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {

namespace {

constexpr double inertia = 0.1;
constexpr int trials = 20000;

struct Body {
    Vec3 v;
    Vec3 spin;
    double energy() const { return 0.5 * squared_norm(v) + 0.5 * inertia * squared_norm(spin); }
};

Vec3 vector_of(RandomStream& random, double width) {
    return {width * random.normal(), width * random.normal(), width * random.normal()};
}

Vec3 direction(RandomStream& random) {
    const Vec3 n = vector_of(random, 1);
    return (1 / norm(n)) * n;
}

ContactLaw random_law(RandomStream& random) {
    ContactLaw law;
    law.restitution = random.uniform();
    law.tangential_restitution = random.uniform(-1, 1);
    law.static_friction = random.uniform();
    law.dynamic_friction = law.static_friction * random.uniform();
    return law;
}

// Approaching bodies, the spins strong enough to make contacts both slide and stick.
struct Pair {
    Body b1;
    Body b2;
    Vec3 n;
};

Pair approaching(RandomStream& random) {
    Pair p{{vector_of(random, 1), vector_of(random, 2)},
           {vector_of(random, 1), vector_of(random, 2)},
           direction(random)};
    if (dot(p.b1.v - p.b2.v, p.n) > 0) p.n = -1.0 * p.n;
    return p;
}

template <Tangential tangential>
Impulse collide(Pair& p, const ContactLaw& law) {
    const Vec3 u = contact_velocity(p.b1.v, p.b2.v, p.b1.spin, p.b2.spin, p.n);
    const Impulse impulse = impulse_of<tangential>(p.n, u, 0.5, law.restitution, law);
    p.b1.v += impulse.j;
    p.b2.v -= impulse.j;
    const Vec3 change = spin_change(p.n, impulse.j);
    p.b1.spin += change;
    p.b2.spin += change;
    return impulse;
}

Vec3 tangential_part(const Vec3& u, const Vec3& n) {
    return u - dot(u, n) * n;
}

}  // namespace

TEST(CollisionRule, ConservesMomentumAndTheSpinDifferenceAlongTheNormal) {
    RandomStream random(1, "collisions");
    for (int i = 0; i < trials; ++i) {
        const ContactLaw law = random_law(random);
        Pair p = approaching(random);
        const Vec3 momentum = p.b1.v + p.b2.v;
        const double twist = dot(p.n, p.b1.spin - p.b2.spin);
        const double spin_along = dot(p.n, p.b1.spin);
        collide<Tangential::coulomb>(p, law);
        EXPECT_LT(norm(p.b1.v + p.b2.v - momentum), 1e-12);
        EXPECT_NEAR(dot(p.n, p.b1.spin - p.b2.spin), twist, 1e-12);
        EXPECT_NEAR(dot(p.n, p.b1.spin), spin_along, 1e-12);
    }
}

TEST(CollisionRule, LosesTheEnergyThatItSaysAndNeverGains) {
    RandomStream random(2, "collisions");
    for (int i = 0; i < trials; ++i) {
        const ContactLaw law = random_law(random);
        Pair p = approaching(random);
        const double before = p.b1.energy() + p.b2.energy();
        const Impulse impulse = collide<Tangential::coulomb>(p, law);
        EXPECT_NEAR(before - p.b1.energy() - p.b2.energy(), impulse.loss, 1e-12 * (1 + before));
        EXPECT_GE(impulse.loss, -1e-13);
    }
}

TEST(CollisionRule, TheLossKeepsItsDigitsHoweverElasticTheGrains) {
    for (const double inelastic : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
        ContactLaw law;
        law.restitution = 1 - inelastic;
        const auto e = static_cast<long double>(law.restitution);
        const Impulse impulse =
            impulse_of<Tangential::smooth>({1, 0, 0}, {-0.7, 0, 0}, 0.5, law.restitution, law);
        const auto wanted = static_cast<double>(0.25L * (1 - e) * (1 + e) * 0.7L * 0.7L);
        EXPECT_NEAR(impulse.loss / wanted, 1, 1e-15) << inelastic;
    }
}

TEST(CollisionRule, ReversesTheNormalVelocityByRestitution) {
    RandomStream random(3, "collisions");
    for (int i = 0; i < trials; ++i) {
        const ContactLaw law = random_law(random);
        Pair p = approaching(random);
        const double before = dot(p.b1.v - p.b2.v, p.n);
        collide<Tangential::coulomb>(p, law);
        EXPECT_NEAR(dot(p.b1.v - p.b2.v, p.n), -law.restitution * before, 1e-12);
    }
}

TEST(CollisionRule, SticksUpToTheStaticBoundAndSlidesBeyond) {
    RandomStream random(4, "collisions");
    int slid = 0;
    for (int i = 0; i < trials; ++i) {
        ContactLaw law = random_law(random);
        Pair p = approaching(random);
        const Vec3 u = contact_velocity(p.b1.v, p.b2.v, p.b1.spin, p.b2.spin, p.n);
        const Vec3 ut = tangential_part(u, p.n);
        const double ratio = norm(ut) / -dot(u, p.n);
        const double bound =
            3.5 * law.static_friction * (1 + law.restitution) / (1 + law.tangential_restitution);
        if (std::abs(ratio / bound - 1) < 1e-9) continue;
        const Impulse impulse = collide<Tangential::coulomb>(p, law);
        EXPECT_EQ(impulse.slides, ratio > bound);
        const Vec3 jt = impulse.j - impulse.normal * p.n;
        if (impulse.slides) {
            ++slid;
            EXPECT_NEAR(norm(jt), law.dynamic_friction * impulse.normal, 1e-12);
            EXPECT_NEAR(dot(jt, ut), -norm(jt) * norm(ut), 1e-12 * (1 + norm(ut)));
        } else {
            const Vec3 after = contact_velocity(p.b1.v, p.b2.v, p.b1.spin, p.b2.spin, p.n);
            const Vec3 rest = tangential_part(after, p.n) + law.tangential_restitution * ut;
            EXPECT_LT(norm(rest), 1e-12 * (1 + norm(ut)));
        }
    }
    EXPECT_GT(slid, trials / 10);
    EXPECT_LT(slid, trials * 9 / 10);
}

TEST(CollisionRule, IsTheSameInTheRestFrameOfAMovingPlate) {
    RandomStream random(5, "collisions");
    for (int i = 0; i < trials; ++i) {
        const ContactLaw law = random_law(random);
        const Vec3 n{0, 0, random.uniform() < 0.5 ? 1.0 : -1.0};
        const Vec3 plate{0, 0, random.normal()};
        Body b{vector_of(random, 1), vector_of(random, 2)};
        if (dot(b.v - plate, n) > 0) b.v -= 2 * dot(b.v - plate, n) * n;
        Body in_rest_frame{b.v - plate, b.spin};
        const double before = in_rest_frame.energy();
        const Vec3 u = b.v - plate - 0.5 * cross(b.spin, n);
        const Impulse impulse = impulse_of<Tangential::coulomb>(n, u, 1, law.restitution, law);
        in_rest_frame.v += impulse.j;
        in_rest_frame.spin += spin_change(n, impulse.j);
        EXPECT_NEAR(before - in_rest_frame.energy(), impulse.loss, 1e-12 * (1 + before));
        EXPECT_GE(impulse.loss, -1e-13);
        // In the laboratory: what the grain gains is the plate's work less the loss.
        const double lab_before = b.energy();
        b.v += impulse.j;
        b.spin += spin_change(n, impulse.j);
        EXPECT_NEAR(b.energy() - lab_before, dot(impulse.j, plate) - impulse.loss,
                    1e-12 * (1 + lab_before));
        EXPECT_NEAR(dot(b.v - plate, n), -law.restitution * dot(u, n), 1e-12);
    }
}

TEST(CollisionRule, PoliciesAreLimitsOfCoulombsLaw) {
    RandomStream random(6, "collisions");
    for (int i = 0; i < trials; ++i) {
        ContactLaw law = random_law(random);
        const Pair p = approaching(random);
        Pair sticking = p;
        Pair coulomb = p;
        law.static_friction = law.dynamic_friction = 1e9;
        collide<Tangential::sticking>(sticking, law);
        collide<Tangential::coulomb>(coulomb, law);
        EXPECT_EQ(sticking.b1.v, coulomb.b1.v);
        law.static_friction = law.dynamic_friction = 0;
        Pair smooth = p;
        coulomb = p;
        collide<Tangential::smooth>(smooth, law);
        collide<Tangential::coulomb>(coulomb, law);
        EXPECT_LT(norm(smooth.b1.v - coulomb.b1.v), 1e-14);
    }
}

}  // namespace grainfield::simulate
