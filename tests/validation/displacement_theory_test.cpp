// Mean squared displacement of motions with closed forms. |Δr|² of independent pairs is
// exponentially distributed: the mean of n of them has the relative standard error 1/sqrt(n), and
// averaging over overlapping pairs is at least as precise as over the disjoint ones. 6 standard
// errors: p < 1e-8 a lag for n ≥ 1000.

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/motion/displacement.h"
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

// A camera that looks for a share t_e of the time between frames sees the mean of the path over the
// exposure (by trapezoids, which is right to 1/400 of t_e or better). 48 movies; their own scatter
// gives the error of the mean, and 6.5 of them are exceeded with p < 1e-7 (Student, 47 degrees of
// freedom) in each of eight comparisons.
TEST(DisplacementTheory, OfBlurredBrownianMotionTellsDiffusionAndLocalisationError) {
    const double d = 0.02;
    const double sigma = 0.05;
    const int steps = 50;  // between frames, one time unit
    for (const int open : {50, 20}) {
        const double exposure = static_cast<double>(open) / steps;
        std::vector<double> of_d, of_sigma, of_exposure, held;
        for (std::uint64_t movie = 0; movie < 48; ++movie) {
            RandomStream random(4, "blurred", movie);
            const Box box = square_box(100, Boundary::walls);
            const auto options = [&](bool knows_exposure, bool knows_sigma) {
                DisplacementOptions o{.lags = LagSpacing::all, .longest = 8};
                if (knows_exposure) o.exposure = exposure;
                if (knows_sigma) o.localisation = sigma;
                return o;
            };
            const int frames = 120;
            Displacement known_exposure(options(true, false), frames);
            Displacement known_sigma(options(false, true), frames);
            Displacement both(options(true, true), frames);
            std::vector<Vec2> at = poisson_points(75, box, random);
            const double step = std::sqrt(2 * d / steps);
            for (int f = 0; f < frames; ++f) {
                std::vector<Vec2> seen(at.size(), Vec2{0, 0});
                for (std::size_t j = 0; j < at.size(); ++j) {
                    for (int s = 0; s < steps; ++s) {
                        const Vec2 next = at[j] + step * Vec2{random.normal(), random.normal()};
                        if (s < open) seen[j] += 0.5 / open * (at[j] + next);
                        at[j] = next;
                    }
                    seen[j] += sigma * Vec2{random.normal(), random.normal()};
                }
                for (Displacement* msd : {&known_exposure, &known_sigma, &both}) {
                    msd->add(linked(seen, box, f));
                }
            }
            const ObservableResult r = known_exposure.result();
            of_d.push_back(*r.find_measurement("d_all")->value);
            of_sigma.push_back(r.find_measurement("localisation_all")->value.value_or(0));
            of_exposure.push_back(
                known_sigma.result().find_measurement("exposure_all")->value.value_or(0));
            held.push_back(*both.result().find_measurement("d_all")->value);
        }
        const auto expect_mean = [](const std::vector<double>& values, double wanted,
                                    double precision) {
            double mean = 0;
            double squares = 0;
            const auto n = static_cast<double>(values.size());
            for (const double v : values) mean += v / n;
            for (const double v : values) squares += (v - mean) * (v - mean);
            const double error = std::sqrt(squares / (n * (n - 1)));
            EXPECT_NEAR(mean, wanted, 6.5 * error);
            EXPECT_LT(error, precision * wanted);
        };
        expect_mean(of_d, d, 0.02);
        expect_mean(of_sigma, sigma, 0.02);
        expect_mean(of_exposure, exposure, 0.08);
        expect_mean(held, d, 0.01);
    }
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
