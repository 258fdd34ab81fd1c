// Mean squared displacement of motions with closed forms. |Δr|² of independent pairs is
// exponentially distributed: the mean of n of them has the relative standard error 1/sqrt(n), and
// averaging over overlapping pairs is at least as precise as over the disjoint ones. 6 standard
// errors: p < 1e-8 a lag for n ≥ 1000.

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/displacement.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

Pattern linked(std::vector<Vec2> points, const Box& box, int frame) {
    Pattern p = pattern(std::move(points), box, frame);
    p.id = identities(p.position.size());
    return p;
}

TEST(DisplacementTheory, OfBrownianMotionIs4Dt) {
    const int frames = 200;
    const std::size_t particles = 1000;
    const double step = 0.3;
    const Box box = square_box(20);
    Displacement msd({}, frames);
    RandomStream random(1, "brownian");
    std::vector<Vec2> points = poisson_points(particles, box, random);
    for (int f = 0; f < frames; ++f) {
        msd.add(linked(points, box, f));
        for (Vec2& p : points) p += step * Vec2{random.normal(), random.normal()};
    }
    const ObservableResult r = msd.result();
    const Curve* curve = r.find_curve("msd");
    for (std::size_t i = 0; i < curve->find("t")->values.size(); ++i) {
        const double lag = curve->find("t")->values[i];
        const double wanted = 2 * step * step * lag;
        const double disjoint = static_cast<double>(particles) * std::floor((frames - 1) / lag);
        EXPECT_NEAR(curve->find("msd")->values[i], wanted, 6 * wanted / std::sqrt(disjoint));
    }
    // The slope over the last decade is no better known than its longest lag alone.
    const double d = 2 * step * step / 4;
    EXPECT_NEAR(*r.find_measurement("d_all")->value, d, 0.2 * d);
    EXPECT_NEAR(*r.find_measurement("exponent_all")->value, 1, 0.1);
}

TEST(DisplacementTheory, OfCagedParticlesIsAPlateauOfFourTimesTheirVariance) {
    const int frames = 200;
    const std::size_t particles = 500;
    const double sigma = 0.05;
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd({}, frames);
    RandomStream random(2, "caged");
    const std::vector<Vec2> home = poisson_points(particles, box, random);
    for (int f = 0; f < frames; ++f) {
        std::vector<Vec2> points = home;
        for (Vec2& p : points) p += sigma * Vec2{random.normal(), random.normal()};
        msd.add(linked(std::move(points), box, f));
    }
    const ObservableResult r = msd.result();
    const Curve* curve = r.find_curve("msd");
    for (std::size_t i = 0; i < curve->find("t")->values.size(); ++i) {
        const double lag = curve->find("t")->values[i];
        const double disjoint = static_cast<double>(particles) * (frames - lag) / 2;
        EXPECT_NEAR(curve->find("msd")->values[i], 4 * sigma * sigma,
                    6 * 4 * sigma * sigma / std::sqrt(disjoint));
    }
    EXPECT_NEAR(*r.find_measurement("exponent_all")->value, 0, 0.05);
}

}  // namespace
}  // namespace grainfield::analysis
