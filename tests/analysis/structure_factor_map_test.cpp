#include <cmath>

#include <gtest/gtest.h>

#include "analysis/structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

constexpr int frames = 64;

// Gaussian modes of S(k) = 1 + m cos(mθ) amplitude.
ObservableResult measured(double two, double four) {
    const Box box = square_box(40);
    StructureFactor sk({.k_max = 2}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(3, "directions", static_cast<std::uint64_t>(f));
        std::vector<std::complex<double>> rho;
        for (const Mode& mode : sk.grid().modes()) {
            const double angle = std::atan2(mode.ny, mode.nx);
            const double s = 1 + two * std::cos(2 * angle) + four * std::cos(4 * angle);
            const double width = std::sqrt(0.5 * 1000 * s);
            rho.emplace_back(width * random.normal(), width * random.normal());
        }
        sk.add({1000, std::move(rho)});
    }
    return sk.result();
}

TEST(StructureFactorMap, HoldsEveryWavevectorOfTheHalfPlane) {
    const ObservableResult r = measured(0.3, 0);
    const Curve* map = r.find_curve("sk_map");
    ASSERT_NE(map, nullptr);
    double sum = 0;
    double count = 0;
    for (const double n : r.find_curve("sk")->find("n")->values) count += n;
    ASSERT_EQ(static_cast<double>(map->find("s")->values.size()), count);
    for (const double s : map->find("s")->values) sum += s;
    EXPECT_NEAR(sum / count, 1, 6 / std::sqrt(count * frames));
}

// About 500 modes, 64 frames: standard error of an amplitude sqrt(2/(n M)) = 0.008.
TEST(StructureFactorMap, FindsTheHarmonicsOfS) {
    const ObservableResult r = measured(0.3, 0.2);
    EXPECT_NEAR(*r.find_measurement("anisotropy_2")->value, 0.3, 0.05);
    EXPECT_NEAR(*r.find_measurement("anisotropy_4")->value, 0.2, 0.05);
    EXPECT_GT(*r.find_measurement("anisotropy_2")->error, 0.002);
    EXPECT_LT(*r.find_measurement("anisotropy_2")->error, 0.03);
}

TEST(StructureFactorMap, OfAnIsotropicPatternShowsChanceOnly) {
    const ObservableResult r = measured(0, 0);
    const Curve* curve = r.find_curve("sk_anisotropy");
    ASSERT_NE(curve, nullptr);
    double ratio = 0;
    for (std::size_t i = 0; i < curve->find("k")->values.size(); ++i) {
        ratio += (curve->find("a2")->values[i] + curve->find("a4")->values[i]) / 2 /
                 curve->find("chance")->values[i];
    }
    // The mean of a Rayleigh number is its unit; 0.52 its spread.
    const auto n = static_cast<double>(curve->find("k")->values.size());
    EXPECT_NEAR(ratio / n, 1, 6 * 0.52 / std::sqrt(2 * n));
    EXPECT_LT(*r.find_measurement("anisotropy_4")->value, 0.05);
}

}  // namespace
}  // namespace grainfield::analysis
