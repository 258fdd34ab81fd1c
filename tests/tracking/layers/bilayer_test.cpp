#include "tracking/layers/bilayer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "tests/support/slit_spheres.h"
#include "tracking/score/layer_score.h"

namespace grainfield::tracking {
namespace {

constexpr double kPixels = 16;

/// Positions in pixels with Gaussian errors [px].
Snapshot seen(const testing::SlitScene& scene, double error) {
    RandomStream random(4, "seen");
    Snapshot s;
    for (const Vec2 p : scene.position) {
        s.position.push_back(kPixels * p + error * Vec2{random.normal(), random.normal()});
        s.position_error.push_back({error, error});
        s.quality.push_back(0.02);
        s.id.push_back(static_cast<std::int64_t>(s.id.size()));
    }
    return s;
}

/// Whether heights exist, by trying all orders of height of the spheres of a small graph.
bool fits(const OverlapGraph& graph, const std::vector<std::uint32_t>& spheres) {
    std::vector<std::uint32_t> order = spheres;
    std::sort(order.begin(), order.end());
    do {
        std::vector<double> z(graph.size(), 0);
        for (const auto i : order) {
            for (const auto link : graph.links(i)) {
                for (const auto below : order) {
                    if (below == i) break;
                    if (below != link.sphere) continue;
                    z[i] = std::max(z[i], z[below] + graph.pairs()[link.pair].rise);
                }
            }
        }
        if (std::all_of(order.begin(), order.end(),
                        [&](auto i) { return z[i] <= graph.slack() + 1e-9; })) {
            return true;
        }
    } while (std::next_permutation(order.begin(), order.end()));
    return false;
}

TEST(Bilayer, ImpossibleSetsAreThosePairsAndTriplesThatNoHeightsFit) {
    RandomStream random(7, "triples");
    int impossible = 0;
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<Vec2> points(3);
        for (Vec2& p : points) p = kPixels * Vec2{random.uniform(0, 1.1), random.uniform(0, 1.1)};
        const OverlapGraph graph({kPixels, 1.94}, points, {});
        const auto sets = impossible_sets(graph);
        bool any_pair = false;
        for (const std::vector<std::uint32_t>& pair :
             {std::vector<std::uint32_t>{0, 1}, {0, 2}, {1, 2}}) {
            const bool listed = std::find(sets.begin(), sets.end(), pair) != sets.end();
            EXPECT_EQ(listed, !fits(graph, pair));
            any_pair = any_pair || listed;
        }
        EXPECT_EQ(sets.empty(), fits(graph, {0, 1, 2})) << trial;
        impossible += !sets.empty() && !any_pair;
    }
    EXPECT_GT(impossible, 20);
}

TEST(Bilayer, ClosestPairAndTriangleAreThoseOfTheHeight) {
    // sqrt(1 - (L - 1)^2) and its triangle: 0.34 a and 0.883 a at L_z = 1.94 a; 0.54 a and 0.907 a
    // at 1.84 a.
    for (const auto& [height, pair, side] :
         {std::tuple{1.94, 0.3412, 0.8827}, std::tuple{1.84, 0.5426, 0.9075}}) {
        for (const double change : {-1e-3, 1e-3}) {
            const double d = kPixels * (pair + change);
            EXPECT_EQ(impossible_sets({{kPixels, height}, {{0, 0}, {d, 0}}, {}}).size(),
                      change < 0 ? 1u : 0u);
            const double s = kPixels * (side + change);
            const std::vector<Vec2> triangle{{0, 0}, {s, 0}, {s / 2, s * std::sqrt(0.75)}};
            EXPECT_EQ(impossible_sets({{kPixels, height}, triangle, {}}).size(),
                      change < 0 ? 1u : 0u);
        }
    }
}

TEST(Bilayer, LeavesEverySphereThatIsThere) {
    for (const double error : {0.0, 0.05, 0.2}) {
        for (const double spacing : {0.72, 0.81, 0.9243}) {
            const auto scene = testing::shaken_bilayer(
                50, 1.94, spacing, spacing > 0.9 ? 0.15 : 0.02, spacing > 0.9 ? 400 : 60, 3);
            Snapshot s = seen(scene, error);
            const std::size_t before = s.size();
            Bilayer bilayer({kPixels, 1.94});
            bilayer.admit(s, std::vector<double>(before, 1));
            // Two standard errors are granted to each overlap: none at all without errors.
            const std::size_t lost = before - s.size();
            if (error == 0) {
                EXPECT_EQ(lost, 0u) << spacing;
            } else {
                EXPECT_LE(static_cast<double>(lost), 0.002 * static_cast<double>(before))
                    << error << " " << spacing;
            }
        }
    }
}

TEST(Bilayer, TakesOutFalseSpheresOfWeakEvidence) {
    const auto scene = testing::shaken_bilayer(40, 1.94, 0.8, 0.02, 60, 3);
    Snapshot s = seen(scene, 0.03);
    std::vector<double> evidence(s.size(), 1);
    const std::size_t there = s.size();
    RandomStream random(9, "false spheres");
    std::size_t close = 0;
    for (std::size_t i = 0; i < there; i += 20) {
        // In the middle between a sphere and its neighbour, or hidden behind one.
        const double distance = i % 40 == 0 ? 0.2 : 0.4;
        const double angle = random.uniform(0, 2 * M_PI);
        s.position.push_back(s.position[i] +
                             distance * kPixels * Vec2{std::cos(angle), std::sin(angle)});
        s.position_error.push_back({0.03, 0.03});
        s.quality.push_back(0.1);
        evidence.push_back(0.2);
        close += distance < 0.3;
    }
    const std::size_t added = s.size() - there;
    s.id.clear();
    Bilayer bilayer({kPixels, 1.94});
    bilayer.admit(s, evidence);
    EXPECT_TRUE(bilayer.summary().is_exact);
    EXPECT_EQ(s.size(), s.quality.size());
    // All false ones go (a dense crystal has room nowhere), and none that is there.
    EXPECT_EQ(s.size(), there);
    EXPECT_EQ(std::count(s.quality.begin(), s.quality.end(), 0.1), 0);
    EXPECT_GE(bilayer.summary().rejected_pairs, static_cast<std::int64_t>(close));
    EXPECT_EQ(bilayer.summary().rejected_pairs + bilayer.summary().rejected_triples,
              static_cast<std::int64_t>(added));
}

TEST(Bilayer, SidesOfACrystalStayFromFrameToFrame) {
    const auto scene = testing::shaken_bilayer(30, 1.94, 0.8, 0.02, 60, 3);
    Bilayer bilayer({kPixels, 1.94});
    Snapshot first = seen(scene, 0);
    bilayer.admit(first, std::vector<double>(first.size(), 1));
    bilayer.label(first);
    ASSERT_GT(std::count(first.layer.begin(), first.layer.end(), Layer::top), 100);
    const auto of = [&](Layer layer) { return std::ranges::count(first.layer, layer); };
    EXPECT_EQ(in_words(bilayer.summary()), std::to_string(of(Layer::bottom)) + " bottom, " +
                                               std::to_string(of(Layer::top)) + " top, " +
                                               std::to_string(of(Layer::unknown)) +
                                               " unknown (overlaps do not tell)");
    // The same spheres in another order, without the first fifth: the naming convention alone
    // would go by index and majority.
    Snapshot next;
    for (std::size_t i = first.size(); i-- > first.size() / 5;) {
        next.position.push_back(first.position[i]);
        next.position_error.push_back({0, 0});
        next.id.push_back(first.id[i]);
    }
    bilayer.admit(next, std::vector<double>(next.size(), 1));
    bilayer.label(next);
    for (std::size_t i = 0; i < next.size(); ++i) {
        if (next.layer[i] == Layer::unknown) continue;
        EXPECT_EQ(next.layer[i], first.layer[static_cast<std::size_t>(next.id[i])]);
    }
}

// With honest errors most overlaps of a liquid force nothing alone. What is named is right all the
// same, in each cluster up to one exchange, as spheres in contact with it are named with it or not
// at all.
TEST(Bilayer, LayersOfSpheresWithErrorsAreRightUpToOneExchangeOfSpheresInContact) {
    for (const double error : {0.1, 0.3}) {  // 0.5 px: 98.8 %
        const auto scene = testing::patch_in_liquid(50, 1.84, 15, 0.81, 0.95, 0.05, 200, 5);
        Snapshot s = seen(scene, error);
        Bilayer bilayer({kPixels, 1.84});
        bilayer.admit(s, std::vector<double>(s.size(), 1));
        bilayer.label(s);
        std::vector<Layer> truth;
        std::vector<Vec2> pixels;
        std::vector<int> partner(scene.z.size(), -1);
        for (std::size_t i = 0; i < scene.z.size(); ++i) {
            truth.push_back(scene.z[i] > 0.42 ? Layer::top : Layer::bottom);
            pixels.push_back(kPixels * scene.position[i]);
        }
        for (std::size_t i = 0; i < s.size(); ++i) {
            partner[static_cast<std::size_t>(s.id[i])] = static_cast<int>(i);
        }
        LayerScore score;
        score.add(pixels, truth, s.layer, partner, kPixels);
        EXPECT_GT(score.accuracy_up_to_flip(), 0.995) << error;
        EXPECT_GT(score.labelled, 800) << error;  // the crystal has some 1,080 spheres
    }
}

TEST(Bilayer, SpheresWithoutRoomTellADiameterThatIsTooLarge) {
    const auto scene = testing::shaken_bilayer(40, 1.94, 0.9243, 0.15, 600, 2);
    const Snapshot s = seen(scene, 0.1);
    const auto share = [&](double diameter, double height) {
        return share_without_room(
            OverlapGraph({diameter * kPixels, height}, s.position, s.position_error));
    };
    EXPECT_EQ(share(1, 1.94), 0);
    EXPECT_GT(share(1.1, 1.94), 0.02);
    EXPECT_GT(share(1, 1.6), 0.02);
    EXPECT_EQ(share_without_room(OverlapGraph({kPixels, 1.94}, {}, {})), 0);
}

TEST(Bilayer, EvidenceMustBeThereForEverySphere) {
    Snapshot s = seen(testing::shaken_bilayer(5, 1.94, 0.8, 0.02, 1, 3), 0);
    Bilayer bilayer({kPixels, 1.94});
    EXPECT_THROW(bilayer.admit(s, {1.0}), InputError);
}

// Two touching spheres of a hexagonal bilayer, d = 0.577 a, one on each plate, 50 a from the axis
// of a camera 700 a away: the upper one, nearer the axis, is displaced outwards by 50 * 0.8165 /
// 700.
TEST(Bilayer, PerspectiveIsGrantedToSpheresFarFromTheAxis) {
    const double seen = 1 / std::sqrt(3.0) - 50 * std::sqrt(2.0 / 3) / 700;
    const std::vector<Vec2> position{{500, 0}, {500 + 10 * seen, 0}};
    SphereCell cell{.diameter = 10, .height = 1.84};
    EXPECT_EQ(impossible_sets(OverlapGraph(cell, position, {})).size(), 1)
        << "a telecentric lens would not show them so near";
    cell.camera_distance = 700;
    EXPECT_TRUE(impossible_sets(OverlapGraph(cell, position, {})).empty());
    cell.axis = {500, 0};
    EXPECT_EQ(impossible_sets(OverlapGraph(cell, position, {})).size(), 1)
        << "nor would this one on its axis";
}

}  // namespace
}  // namespace grainfield::tracking
