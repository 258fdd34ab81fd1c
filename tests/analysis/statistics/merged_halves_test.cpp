// A run analysed in two halves that are merged gives the results of the whole: values, errors,
// numbers of samples and curves, within rounding, for every observable of particles. What is made
// of S(k) (fit, synthetic) follows from it.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/density/number_variance.h"
#include "analysis/motion/displacement.h"
#include "analysis/order/bond_statistics.h"
#include "analysis/order/order_correlation.h"
#include "analysis/order/phase.h"
#include "analysis/order/solid_clusters.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/order_structure_factor.h"
#include "analysis/spectra/structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

constexpr int frames = 120;
constexpr double rounding = 1e-9;

bool near(double a, double b) {
    if (std::isnan(a) || std::isnan(b)) return std::isnan(a) == std::isnan(b);
    return std::abs(a - b) <= rounding * std::max({std::abs(a), std::abs(b), 1e-3});
}

void expect_same(const ObservableResult& a, const ObservableResult& b) {
    EXPECT_EQ(a.reason, b.reason);
    ASSERT_EQ(a.measurements.size(), b.measurements.size()) << a.name;
    for (std::size_t i = 0; i < a.measurements.size(); ++i) {
        const Measurement& x = a.measurements[i];
        const Measurement& y = b.measurements[i];
        ASSERT_EQ(x.value.has_value(), y.value.has_value()) << x.name;
        ASSERT_EQ(x.error.has_value(), y.error.has_value()) << x.name;
        EXPECT_TRUE(near(x.value.value_or(0), y.value.value_or(0))) << x.name;
        EXPECT_TRUE(near(x.error.value_or(0), y.error.value_or(0))) << x.name;
        EXPECT_TRUE(near(x.samples, y.samples)) << x.name << x.samples << " " << y.samples;
    }
    ASSERT_EQ(a.curves.size(), b.curves.size()) << a.name;
    for (std::size_t c = 0; c < a.curves.size(); ++c) {
        ASSERT_EQ(a.curves[c].name, b.curves[c].name);
        for (std::size_t i = 0; i < a.curves[c].columns.size(); ++i) {
            const Column& x = a.curves[c].columns[i];
            const Column& y = b.curves[c].columns[i];
            ASSERT_EQ(x.values.size(), y.values.size()) << a.curves[c].name;
            for (std::size_t j = 0; j < x.values.size(); ++j) {
                EXPECT_TRUE(near(x.values[j], y.values[j]))
                    << a.curves[c].name << "." << x.name << " " << j;
            }
        }
    }
}

// Half a crystal that drifts and trembles, half a gas, four frames to a phase window.
class Film {
 public:
    explicit Film(Boundary boundary) : box(square_box(24, boundary)) {
        points_ = square_lattice(24, 1, 0.03, random_);
        for (Vec2& p : points_) {
            if (p.x > 12) p = {12 + 12 * random_.uniform(), 24 * random_.uniform()};
        }
        info.time_unit = TimeUnit::second;
    }

    Pattern next(int f) {
        std::vector<Vec2> now;
        for (Vec2& p : points_) {
            if (p.x > 12) {
                p = p + 0.05 * Vec2{random_.normal(), random_.normal()};
                p = {std::clamp(p.x, 12.01, 23.99), std::clamp(p.y, 0.01, 23.99)};
            }
            now.push_back(p + 0.06 * Vec2{random_.uniform() - 0.5, random_.uniform() - 0.5});
        }
        for (Vec2& p : now) p = {std::clamp(p.x, 0.0, 23.999), std::clamp(p.y, 0.0, 23.999)};
        Pattern here = pattern(now, box, f);
        here.time = 0.1 * f;
        here.id = identities(now.size());
        return here;
    }

    Box box;
    TrajectoryInfo info;

 private:
    RandomStream random_{9, "merged halves"};
    std::vector<Vec2> points_;
};

template <class A>
struct Halves {
    A whole, first, second;

    template <class Sample>
    void add(int frame, const Sample& sample) {
        whole.add(sample);
        (frame < frames / 2 ? first : second).add(sample);
    }
    void expect_same_when_merged() {
        first.merge(second);
        expect_same(whole.result(), first.result());
    }
};

TEST(MergedHalves, GiveTheResultOfTheWholeForEveryObservable) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
        Film film(boundary);
        const DisplacementOptions msd{.van_hove = {1, 10}};
        const StructureFactorOptions sk{.k_max = 1.5};
        const OrderStructureFactorOptions s4;
        const NumberVarianceOptions windows{.largest = 12};
        Halves<BondStatistics> bonds{BondStatistics({}), BondStatistics({}), BondStatistics({})};
        Halves<PhaseHistory> phases{
            {{}, film.info, frames}, {{}, film.info, frames / 2}, {{}, film.info, frames / 2}};
        Halves<Displacement> moved{{msd, frames}, {msd, frames / 2}, {msd, frames / 2}};
        Halves<StructureFactor> density{
            {sk, film.box, frames}, {sk, film.box, frames / 2}, {sk, film.box, frames / 2}};
        Halves<OrderStructureFactor> order{
            {s4, film.box, frames}, {s4, film.box, frames / 2}, {s4, film.box, frames / 2}};
        Halves<NumberVariance> variance{{windows, film.box, frames},
                                        {windows, film.box, frames / 2},
                                        {windows, film.box, frames / 2}};
        for (int f = 0; f < frames; ++f) {
            const Pattern here = film.next(f);
            const BondStatistics::Sample sample = BondStatistics::measure(here, {});
            PhaseHistory::Sample of_phase{here.frame, here.time, here.id, {}};
            for (const auto& q : sample.field->q) {
                of_phase.abs_q.push_back(static_cast<float>(std::abs(q)));
            }
            bonds.add(f, sample);
            phases.add(f, of_phase);
            moved.add(f, here);
            density.add(f, density.whole.measure(here));
            order.add(f, order.whole.measure(here, sample.field->q));
            variance.add(f, variance.whole.measure(here));
        }
        bonds.expect_same_when_merged();
        phases.expect_same_when_merged();
        moved.expect_same_when_merged();
        density.expect_same_when_merged();
        order.expect_same_when_merged();
        variance.expect_same_when_merged();
        const FitOptions fit{.k_max = 1.2, .bootstrap = 60};
        expect_same(fit_result(density.whole, fit), fit_result(density.first, fit));
    }
}

}  // namespace
}  // namespace grainfield::analysis
