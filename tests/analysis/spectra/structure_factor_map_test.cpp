#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/spectra/structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

constexpr int frames = 64;

// Gaussian modes of S(k) = 1 + m cos(mθ) amplitude.
ObservableResult measured(double two, double four, int number = frames, int without = -1) {
    const Box box = square_box(40);
    StructureFactor sk({.k_max = 2}, box, without < 0 ? number : number - 1);
    for (int f = 0; f < number; ++f) {
        if (f == without) continue;
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

TEST(StructureFactorMap, HasAnErrorOfItsAnisotropyWithStudentsFactor) {
    for (const char* name : {"anisotropy_2", "anisotropy_4"}) {
        std::vector<double> left;
        for (int f = 0; f < 8; ++f) {
            left.push_back(*measured(0.3, 0.2, 8, f).find_measurement(name)->value);
        }
        const Measurement m = *measured(0.3, 0.2, 8).find_measurement(name);
        EXPECT_NEAR(*m.error, *student_jackknife_error(left), 1e-12) << name;
    }
}

TEST(StructureFactorMap, OfAnIsotropicPatternShowsChanceOnly) {
    const ObservableResult r = measured(0, 0);
    EXPECT_LT(*r.find_measurement("anisotropy_4")->value, 0.05);
}

// What is said to be chance is the mean over many isotropic patterns, in every shell and of all of
// them, also where few frames, few modes, directions of the grid and overlaps between walls count.
// The amplitude of a trial scatters by half of its mean or a little more (a Rayleigh number by
// 0.52, one along an axis by 0.76): six standard errors of the mean over the trials, and 3 % for
// modes of points, which are not quite normal, and for overlaps left out.
TEST(StructureFactorMap, OfPoissonFramesHasTheAmplitudeThatIsSaidToBeChance) {
    struct Case {
        Boundary boundary;
        int frames;
        int trials;
        double k_max;
    };
    for (const Case& c :
         {Case{Boundary::periodic, 2, 1500, 3}, Case{Boundary::periodic, 40, 400, 3},
          Case{Boundary::walls, 3, 1000, 1.6}, Case{Boundary::walls, 12, 400, 1.6}}) {
        const Box box = square_box(20, c.boundary);
        std::vector<std::array<double, 2>> found;
        std::vector<std::array<double, 2>> said;
        for (int trial = 0; trial < c.trials; ++trial) {
            StructureFactor sk({.k_max = c.k_max}, box, c.frames);
            RandomStream random(8, "isotropic", static_cast<std::uint64_t>(trial));
            for (int f = 0; f < c.frames; ++f) {
                sk.add(sk.measure(pattern(poisson_points(300, box, random), box, f)));
            }
            const ObservableResult r = sk.result();
            const Curve* curve = r.find_curve("sk_anisotropy");
            ASSERT_NE(curve, nullptr);
            const std::size_t shells = curve->find("k")->values.size();
            found.resize(shells + 1);
            said.resize(shells + 1);
            for (std::size_t h = 0; h < 2; ++h) {
                for (std::size_t i = 0; i < shells; ++i) {
                    found[i][h] += curve->columns[1 + h].values[i] / c.trials;
                    said[i][h] += curve->columns[3 + h].values[i] / c.trials;
                }
                const Measurement* m = r.find_measurement(h == 0 ? "anisotropy_2" : "anisotropy_4");
                found[shells][h] += *m->value / c.trials;
                const std::string& text = m->reason;
                said[shells][h] += std::stod(text.substr(text.find("shows ") + 6)) / c.trials;
            }
        }
        ASSERT_GE(found.size(), 3U);
        double ratio = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            for (std::size_t h = 0; h < 2; ++h) {
                const double bar = 0.03 + 6 * 0.76 / std::sqrt(1.0 * c.trials);
                EXPECT_NEAR(found[i][h] / said[i][h], 1, bar)
                    << c.frames << " frames, shell " << i << " of " << found.size();
                ratio += found[i][h] / said[i][h] / (2.0 * static_cast<double>(found.size()));
            }
        }
        // Shells are independent, or nearly so between walls.
        const double number = 2.0 * c.trials * static_cast<double>(found.size());
        EXPECT_NEAR(ratio, 1, 0.03 + 6 * 0.6 / std::sqrt(number)) << c.frames << " frames";
    }
}

}  // namespace
}  // namespace grainfield::analysis
