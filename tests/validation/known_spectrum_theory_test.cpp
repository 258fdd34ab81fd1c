// S0/S1, its errors and the critical point of layers between walls whose S(k) is put in: what
// bench/analysis/known_spectrum.cpp measures at the size of the experiment
// (docs/paper/known-answer.md).

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/spectra/fit_result.h"
#include "analysis/statistics/critical.h"
#include "tests/analysis/synthetic_patterns.h"
#include "tests/support/known_spectrum.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

using grainfield::testing::KnownSpectrumLayer;
using grainfield::testing::Pull;

constexpr double side = 40;
constexpr int frames = 40;
constexpr int trials = 20;

struct Fitted {
    std::optional<CriticalPoint> box, planes;  // none where S1 is not above two of its errors
};

// One run at S0/S1 = ratio; the control parameter is the ratio itself, so that it vanishes at zero.
std::vector<Fitted> runs(double ratio, double alpha) {
    grainfield::testing::KnownSpectrumOptions options;
    options.side = side;
    options.liquids = 4;
    options.melt = 20;
    options.tolerance = 1e-3;
    options.seed = static_cast<std::uint64_t>(1000 * ratio + 100000 * alpha);
    options.wanted = {.s0 = ratio, .s1 = 1, .alpha = alpha, .peak = 0.5, .cut = 0.7};
    KnownSpectrumLayer layer(options);
    const Box box = square_box(side, Boundary::walls);
    std::vector<Fitted> fitted;
    for (int trial = 0; trial < trials; ++trial) {
        StructureFactor sk({.k_max = 0.7}, box, frames);
        for (int f = 0; f < frames; ++f) {
            sk.add(sk.measure(pattern(layer.next().position, box, f)));
        }
        const auto point = [&](FitModes modes) {
            const ObservableResult fit =
                fit_result(sk, {.alpha = alpha, .k_max = 0.45, .modes = modes, .bootstrap = 60});
            const Measurement* m = fit.find_measurement("s0_over_s1");
            EXPECT_EQ(fit.reason, "");
            if (!m->value) return std::optional<CriticalPoint>();
            return std::optional(CriticalPoint{ratio, *m->value, m->error.value()});
        };
        fitted.push_back({point(FitModes::box), point(FitModes::plane_waves)});
    }
    return fitted;
}

// 80 pulls for each exponent: their mean has a standard error of .11, their width of about .1 (1.3
// times that of normal numbers, for the long tails of a ratio). Bars: four of them.
//
// An interval of the critical value is to cover it in 68 %. Measured are 25 of the 40 here, and 23
// of 26 at the size of the experiment. Fewer than 17 of 40 have a probability of 2e-4. That all 20
// of an exponent are covered would say nothing, so intervals that are too wide are found by half of
// them. Halved about the critical value, they cover it in 38 %, and in 48 % if they cover in 80 %:
// 30 or more of 40 have 2e-6 and 4e-4. Three times too wide, they fail in 98 % of such tests.
TEST(KnownSpectrumTheory, ModesBetweenWallsCoverTheRatioAndTheCriticalPointAndPlaneWavesDoNot) {
    int covered = 0;
    int covered_by_half = 0;
    for (const double alpha : {1.0, 1.5}) {
        std::vector<std::vector<Fitted>> series;
        Pull box, planes;
        for (const double ratio : {0.1, 0.07, 0.04, 0.0}) {
            series.push_back(runs(ratio, alpha));
            for (const Fitted& f : series.back()) {
                if (f.box) box.add((f.box->ratio - ratio) / f.box->error);
                if (f.planes) planes.add((f.planes->ratio - ratio) / f.planes->error);
            }
        }
        // S1 is above two of its errors in 79 and 80 of 80: what is left out selects next to
        // nothing.
        EXPECT_GE(box.count, 76) << alpha;
        EXPECT_GE(planes.count, 76) << alpha;
        EXPECT_LT(std::abs(box.mean()), 0.45) << alpha;
        EXPECT_GT(box.width(), 0.6) << alpha;
        EXPECT_LT(box.width(), 1.4) << alpha;
        // Plane waves leak: S0/S1 is too small, by more than the error that is quoted.
        EXPECT_LT(planes.mean(), -0.8) << alpha;
        for (std::size_t trial = 0; trial < trials; ++trial) {
            std::vector<CriticalPoint> points;
            for (const auto& of_ratio : series) {
                if (of_ratio[trial].box) points.push_back(*of_ratio[trial].box);
            }
            const CriticalFit fit = fit_critical(points, CriticalLine::free);
            if (!fit.interval || !fit.critical) continue;
            const double low = fit.interval->low, high = fit.interval->high;
            covered += low <= 0 && high >= 0 ? 1 : 0;
            covered_by_half += low + *fit.critical <= 0 && high + *fit.critical >= 0 ? 1 : 0;
        }
    }
    RecordProperty("covered", covered);
    RecordProperty("covered_by_half", covered_by_half);
    EXPECT_GE(covered, 17) << "too narrow";
    EXPECT_LT(covered_by_half, 30) << "too wide";
}

}  // namespace
}  // namespace grainfield::analysis
