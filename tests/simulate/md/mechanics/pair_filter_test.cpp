#include "simulate/md/mechanics/pair_filter.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

// Grains around the first one, some touching it, some overlapping, some in its past.
std::vector<Grain> neighbourhood(std::mt19937_64& random) {
    std::uniform_real_distribution<double> place(-1.6, 1.6);
    std::normal_distribution<double> speed;
    std::uniform_real_distribution<double> time(0, 0.5);
    std::vector<Grain> grains(1 + random() % 40);
    for (Grain& g : grains) {
        g.r = {place(random), place(random), place(random)};
        g.v = {speed(random), speed(random), speed(random)};
        g.t = time(random);
        if (random() % 8 == 0) g.t = grains[0].t;
    }
    grains[0].r = {};
    return grains;
}

template <bool has_gravity>
void keeps_what_pair_time_keeps(double gravity) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> limit_of(0.5, 1.5);
    const PairFilter filter = pair_filter<has_gravity>();
    std::size_t met = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const std::vector<Grain> grains = neighbourhood(random);
        const Vec3 shift = trial % 3 == 0 ? Vec3{0.25, -0.5, 0.125} : Vec3{};
        const double limit = limit_of(random);
        std::vector<std::int32_t> near(grains.size() + pair_filter_room);
        std::vector<std::int32_t> expected;
        for (std::size_t j = 0; j < grains.size(); ++j) {
            near[j] = static_cast<std::int32_t>(j);
            const double t = pair_time<has_gravity>(grains[0], grains[j], shift, gravity, limit);
            if (t < never) expected.push_back(near[j]);
        }
        const std::size_t count =
            filter(grains[0], grains.data(), shift, gravity, limit, near.data(), grains.size());
        near.resize(count);
        ASSERT_EQ(near, expected) << "trial " << trial;
        met += count;
    }
    EXPECT_GT(met, 20000U);  // the comparison was of something
}

TEST(PairFilter, KeepsExactlyWhatPairTimeKeeps) {
    keeps_what_pair_time_keeps<false>(0);
}

TEST(PairFilter, KeepsExactlyWhatPairTimeKeepsUnderGravity) {
    keeps_what_pair_time_keeps<true>(1);
}

TEST(PairFilter, OfNobodyKeepsNobody) {
    const Grain grain{};
    std::vector<std::int32_t> near(pair_filter_room);
    EXPECT_EQ(pair_filter<false>()(grain, &grain, {}, 0, 1, near.data(), 0), 0U);
}

}  // namespace
}  // namespace grainfield::simulate
