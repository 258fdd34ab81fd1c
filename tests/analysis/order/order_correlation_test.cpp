#include "analysis/order/order_correlation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

BondOrderField field_of(const std::vector<std::complex<double>>& q) {
    BondOrderField field;
    field.q = q;
    return field;
}

void add(OrderCorrelation& correlation, const Pattern& here,
         const std::vector<std::complex<double>>& q, int frame) {
    const BondOrderField field = field_of(q);
    correlation.add(correlation.measure(here, field, frame), here, field);
}

// Order of which no two particles know.
std::vector<std::complex<double>> unrelated(std::size_t n, RandomStream& random) {
    std::vector<std::complex<double>> q;
    for (std::size_t i = 0; i < n; ++i) {
        q.push_back(std::polar(0.5, 2 * std::numbers::pi * random.uniform()));
    }
    return q;
}

// Particles whose order is exp(i φ_j(t)), φ a random walk with ⟨Δφ²⟩ = 2 D t: C(τ) = exp(−D τ).
TEST(OrderCorrelation, InTimeIsThatOfPhasesThatDiffuse) {
    const int frames = 256;
    const std::size_t n = 4000;
    const double rate = 0.05;
    const Box box = square_box(60);
    OrderCorrelation correlation(box, frames);
    RandomStream random(1, "phases");
    std::vector<double> phase(n);
    for (double& p : phase) p = 2 * std::numbers::pi * random.uniform();
    const std::vector<Vec2> points = poisson_points(n, box, random);
    for (int f = 0; f < frames; ++f) {
        std::vector<std::complex<double>> q;
        for (double& p : phase) {
            q.push_back(std::polar(0.5, p));
            p += std::sqrt(2 * rate) * random.normal();
        }
        Pattern here = pattern(points, box, f);
        here.time = 0.5 * f;
        here.id = identities(n);
        // Another order of the particles in every frame, and one that comes and goes.
        const auto turn = static_cast<std::ptrdiff_t>(f % 7);
        std::rotate(here.id.begin(), here.id.begin() + turn, here.id.end());
        std::rotate(here.position.begin(), here.position.begin() + turn, here.position.end());
        std::rotate(q.begin(), q.begin() + turn, q.end());
        if (f % 2 == 1) q[5] = {std::nan(""), 0};
        add(correlation, here, q, f);
    }
    ObservableResult result;
    correlation.add_to(result);
    const Curve* curve = result.find_curve("q4_time");
    ASSERT_NE(curve, nullptr);
    const auto& t = curve->find("t")->values;
    for (std::size_t i = 0; i < t.size(); ++i) {
        // A start has 4000 particles: standard error below 1/sqrt(2 · 4000) = 0.011; 6 of them.
        EXPECT_NEAR(curve->find("c")->values[i], std::exp(-rate * t[i] / 0.5), 0.07) << t[i];
    }
    const Measurement* time = result.find_measurement("order_time");
    EXPECT_NEAR(*time->value, 0.5 / rate, 1);
    EXPECT_GT(*time->error, 0);
    EXPECT_LT(*time->error, 1);
}

// Of phases that are new in each frame the time is shorter than any that frames can tell.
TEST(OrderCorrelation, InTimeHasNoLengthBelowTheIntervalOfFrames) {
    const int frames = 32;
    const Box box = square_box(30);
    OrderCorrelation correlation(box, frames);
    RandomStream random(4, "new phases");
    const std::vector<Vec2> points = poisson_points(500, box, random);
    for (int f = 0; f < frames; ++f) {
        const auto q = unrelated(points.size(), random);
        Pattern here = pattern(points, box, f);
        here.time = 2.5 * f;
        here.id = identities(points.size());
        add(correlation, here, q, f);
    }
    ObservableResult result;
    correlation.add_to(result);
    const Measurement* time = result.find_measurement("order_time");
    ASSERT_NE(time, nullptr);
    EXPECT_FALSE(time->value.has_value());
    EXPECT_FALSE(time->error.has_value());
    EXPECT_THAT(time->reason, testing::HasSubstr("below 1/e already at 2.5"));
}

// Stripes of order that turn with x: Q = exp(i κ x); C(r) = J0(κ r) by averaging over directions.
TEST(OrderCorrelation, InSpaceIsTheBesselFunctionOfAPlaneWave) {
    const double length = 40;
    const double kappa = 2 * std::numbers::pi / length * 4;
    const Box box = square_box(length);
    const int frames = 64;
    OrderCorrelation correlation(box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(2, "wave", static_cast<std::uint64_t>(f));
        const Pattern here = pattern(poisson_points(1500, box, random), box, f);
        std::vector<std::complex<double>> q;
        for (const Vec2& p : here.position) q.push_back(std::polar(1.0, kappa * p.x));
        add(correlation, here, q, f);
    }
    ObservableResult result;
    correlation.add_to(result);
    const Curve* curve = result.find_curve("q4_space");
    ASSERT_NE(curve, nullptr);
    const auto& r = curve->find("r")->values;
    EXPECT_NEAR(r.back(), 9.95, 1e-9);
    for (std::size_t i = 0; i < r.size(); ++i) {
        const double pairs = 0.5 * curve->find("n")->values[i];
        EXPECT_NEAR(curve->find("c")->values[i], std::cyl_bessel_j(0, kappa * r[i]),
                    6 * std::sqrt(0.5 / pairs) + 0.002)
            << r[i];
    }
    EXPECT_THAT(result.find_measurement("order_time")->reason, testing::HasSubstr("not linked"));
    EXPECT_TRUE(result.find_measurement("order_length")->value.has_value());
}

// Whatever frame the run is cut at, and also in three parts.
TEST(OrderCorrelation, OfMergedPartsIsThatOfTheWhole) {
    const int frames = 50;
    const Box box = square_box(12);
    for (const std::vector<int>& cuts : {std::vector<int>{25}, {7}, {12, 31}}) {
        OrderCorrelation whole(box, frames);
        std::vector<OrderCorrelation> parts{OrderCorrelation(box, frames)};
        for (const int cut : cuts) parts.emplace_back(box, frames, cut);
        RandomStream random(5, "parts");
        std::vector<Vec2> points = poisson_points(150, box, random);
        std::size_t part = 0;
        for (int f = 0; f < frames; ++f) {
            if (part < cuts.size() && f == cuts[part]) ++part;
            for (Vec2& p : points) p = box.wrap(p + 0.5 * Vec2{random.normal(), random.normal()});
            std::vector<std::complex<double>> q;
            for (const Vec2& p : points) {
                q.push_back(std::polar(0.8, p.x) + 0.2 * std::polar(1.0, random.normal()));
            }
            Pattern here = pattern(points, box, f);
            here.id = identities(points.size());
            const BondOrderField field = field_of(q);
            whole.add(whole.measure(here, field, f), here, field);
            parts[part].add(parts[part].measure(here, field, f), here, field);
        }
        // The later ones first: merging is associative.
        while (parts.size() > 1) {
            parts[parts.size() - 2].merge(parts.back());
            parts.pop_back();
        }
        ObservableResult a, b;
        whole.add_to(a);
        parts.front().add_to(b);
        ASSERT_EQ(a.curves.size(), 2U);
        for (const Curve& curve : a.curves) {
            for (const Column& column : curve.columns) {
                const auto& other = b.find_curve(curve.name)->find(column.name)->values;
                ASSERT_EQ(other.size(), column.values.size()) << curve.name;
                for (std::size_t i = 0; i < other.size(); ++i) {
                    if (std::isnan(column.values[i])) continue;
                    EXPECT_NEAR(other[i], column.values[i],
                                1e-12 * std::abs(column.values[i]) + 1e-14);
                }
            }
        }
        for (const char* name : {"order_length", "order_time"}) {
            const Measurement* of_whole = a.find_measurement(name);
            const Measurement* of_parts = b.find_measurement(name);
            ASSERT_TRUE(of_whole->value.has_value()) << of_whole->reason;
            EXPECT_NEAR(*of_parts->value, *of_whole->value, 1e-12 * *of_whole->value);
            EXPECT_NEAR(of_parts->error.value_or(-1), of_whole->error.value_or(-1), 1e-9);
        }
    }
    OrderCorrelation first(box, frames), strange(box, frames, 30);
    EXPECT_THROW(first.merge(strange), InputError);
}

// Neighbours at random angles: 1/e is passed before the first neighbour.
TEST(OrderCorrelation, HasNoLengthBelowADiameter) {
    const int frames = 20;
    const Box box = square_box(30);
    OrderCorrelation correlation(box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(6, "short", static_cast<std::uint64_t>(f));
        const Pattern here = pattern(poisson_points(900, box, random), box, f);
        const auto q = unrelated(here.size(), random);
        add(correlation, here, q, f);
    }
    ObservableResult result;
    correlation.add_to(result);
    const Measurement* length = result.find_measurement("order_length");
    EXPECT_FALSE(length->value.has_value());
    EXPECT_THAT(length->reason, testing::HasSubstr("diameter"));
    EXPECT_NE(result.find_curve("q4_space"), nullptr);
}

TEST(OrderCorrelation, HasReasonsWhereNothingCanBeSaid) {
    for (const int frames : {0, 1, 2}) {
        const Box box = square_box(5);
        OrderCorrelation correlation(box, frames);
        for (int f = 0; f < frames; ++f) {
            Pattern here = pattern({{1, 1}, {2, 2}}, box, f);
            here.id = identities(2);
            const BondOrderField field = field_of({{1, 0}, {std::nan(""), std::nan("")}});
            correlation.add(correlation.measure(here, field, f), here, field);
        }
        ObservableResult result;
        correlation.add_to(result);
        for (const Measurement& m : result.measurements) {
            EXPECT_FALSE(m.value.has_value()) << m.name << frames;
            EXPECT_NE(m.reason, "") << m.name << frames;
        }
    }
}

}  // namespace
}  // namespace grainfield::analysis
