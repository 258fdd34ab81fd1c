// Wrong links against truth and against the optimal assignment, which is also what trackpy
// minimises: least Σ d² with search_range² for each track left alone.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/layer_frames.h"
#include "tracking/link/linker.h"
#include "tracking/score/track_scores.h"

namespace grainfield::tracking {
namespace {

constexpr double kDiameter = 12;

/// Dense Hungarian method with a private dummy column a row, O(n³): the oracle.
std::vector<int> hungarian(const std::vector<Vec2>& tracks, const std::vector<Vec2>& particles,
                           double range) {
    const std::size_t n = tracks.size();
    const std::size_t m = particles.size() + n;
    const auto cost = [&](std::size_t i, std::size_t j) {
        const double r2 = range * range;
        if (j >= particles.size()) return j - particles.size() == i ? r2 : 1e12;
        const double d2 = squared_norm(particles[j] - tracks[i]);
        return d2 <= r2 ? d2 : 1e12;
    };
    std::vector<double> u(n + 1, 0), v(m + 1, 0);
    std::vector<std::size_t> row(m + 1, 0), way(m + 1, 0);
    for (std::size_t i = 1; i <= n; ++i) {
        row[0] = i;
        std::size_t j0 = 0;
        std::vector<double> least(m + 1, std::numeric_limits<double>::infinity());
        std::vector<char> used(m + 1, 0);
        do {
            used[j0] = 1;
            const std::size_t i0 = row[j0];
            std::size_t j1 = 0;
            double delta = std::numeric_limits<double>::infinity();
            for (std::size_t j = 1; j <= m; ++j) {
                if (used[j]) continue;
                const double reduced = cost(i0 - 1, j - 1) - u[i0] - v[j];
                if (reduced < least[j]) {
                    least[j] = reduced;
                    way[j] = j0;
                }
                if (least[j] < delta) {
                    delta = least[j];
                    j1 = j;
                }
            }
            for (std::size_t j = 0; j <= m; ++j) {
                if (used[j]) {
                    u[row[j]] += delta;
                    v[j] -= delta;
                } else {
                    least[j] -= delta;
                }
            }
            j0 = j1;
        } while (row[j0] != 0);
        while (j0 != 0) {
            row[j0] = row[way[j0]];
            j0 = way[j0];
        }
    }
    std::vector<int> partner(n, -1);
    for (std::size_t j = 1; j <= particles.size(); ++j) {
        if (row[j] != 0) partner[row[j] - 1] = static_cast<int>(j - 1);
    }
    return partner;
}

enum class Matter { liquid, crystal };

testing::LayerScene scene_of(Matter matter, int size) {
    if (matter == Matter::liquid) {
        return testing::hard_disc_liquid(size, size, kDiameter, 0.72, 5);
    }
    testing::CrystalPatch patch;
    patch.radius = 0.35;
    patch.spacing = 0.81;
    patch.jitter = 0;
    return testing::crystal_in_liquid(size, size, kDiameter, 0.72, patch, 5);
}

/// Spheres that rattle about their places; steps of the given RMS between frames.
class Rattle {
 public:
    Rattle(const testing::LayerScene& scene, double step, double dropouts, std::uint64_t seed)
        : scene_(scene), sigma_(step / 2), dropouts_(dropouts), seed_(seed) {}

    IdentifiedFrame frame(int number) const {
        RandomStream random(seed_, "rattle", static_cast<std::uint64_t>(number));
        IdentifiedFrame f;
        for (std::size_t i = 0; i < scene_.position.size(); ++i) {
            const Vec2 p = scene_.position[i] + sigma_ * Vec2{random.normal(), random.normal()};
            if (random.uniform() < dropouts_) continue;
            f.id.push_back(static_cast<std::int64_t>(i));
            f.position.push_back(p);
        }
        return f;
    }

 private:
    const testing::LayerScene& scene_;
    double sigma_, dropouts_;
    std::uint64_t seed_;
};

class SmallSteps : public ::testing::TestWithParam<std::tuple<Matter, double, double>> {};

TEST_P(SmallSteps, MakeNoWrongLink) {
    const auto [matter, step, dropouts] = GetParam();
    const auto scene = scene_of(matter, 700);
    const Rattle rattle(scene, step * kDiameter, dropouts, 1);
    Linker linker({.search_range = kDiameter / 2, .memory = 3});
    std::vector<IdentifiedFrame> truth, found;
    for (int f = 0; f < 10; ++f) {
        truth.push_back(rattle.frame(f));
        found.push_back({linker.link(f, truth.back().position), truth.back().position});
    }
    const auto scores = score_tracks(found, truth, 0.25 * kDiameter);
    // A memory of 3 loses a sphere that is missing 4 frames in a row: at 5 % dropouts 6e-6 each.
    EXPECT_EQ(scores.switches, 0);
    EXPECT_EQ(scores.wrong_links, 0);
    EXPECT_GT(scores.links, 20000);
    EXPECT_EQ(scores.alpha, 1);
    EXPECT_EQ(scores.jaccard_tracks, 1);
}

INSTANTIATE_TEST_SUITE_P(Linking, SmallSteps,
                         ::testing::Combine(::testing::Values(Matter::liquid, Matter::crystal),
                                            ::testing::Values(0.05, 0.10),
                                            ::testing::Values(0.0, 0.01, 0.05)));

class LargeSteps : public ::testing::TestWithParam<std::tuple<Matter, double, double, double>> {};

TEST_P(LargeSteps, AreLinkedAsTheOptimalAssignmentLinksThem) {
    const auto [matter, step, dropouts, range] = GetParam();
    const auto scene = scene_of(matter, 240);
    const Rattle rattle(scene, step * kDiameter, dropouts, 2);
    const double search = range * kDiameter;
    for (int f = 0; f < 2; ++f) {
        const auto before = rattle.frame(2 * f);
        const auto after = rattle.frame(2 * f + 1);
        Linker linker({.search_range = search, .memory = 0});
        const auto ids = linker.link(0, before.position);
        const auto now = linker.link(1, after.position);
        EXPECT_EQ(linker.summary().subnets.reduced, 0);
        std::vector<int> links(before.position.size(), -1);
        for (std::size_t j = 0; j < now.size(); ++j) {
            if (now[j] < static_cast<std::int64_t>(links.size())) {
                links[static_cast<std::size_t>(now[j])] = static_cast<int>(j);
            }
        }
        // Costs that are real numbers have one optimum.
        EXPECT_EQ(links, hungarian(before.position, after.position, search));
    }
}

INSTANTIATE_TEST_SUITE_P(Linking, LargeSteps,
                         ::testing::Combine(::testing::Values(Matter::liquid, Matter::crystal),
                                            ::testing::Values(0.15, 0.3, 0.4),
                                            ::testing::Values(0.01, 0.05),
                                            ::testing::Values(0.5, 1.0)));

}  // namespace
}  // namespace grainfield::tracking
