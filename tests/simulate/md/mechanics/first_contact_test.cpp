#include "simulate/md/mechanics/first_contact.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

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

// The oracle: one candidate after the other.
template <bool has_gravity>
Contact one_by_one(const Grain& grain, const std::vector<Grain>& grains, double gravity,
                   double limit, const Candidates& near) {
    Contact first{limit, -1};
    for (std::size_t k = 0; k < near.count; ++k) {
        const Vec3 shift =
            near.is_shifted ? Vec3{near.shift_x[k], near.shift_y[k], near.shift_z[k]} : Vec3{};
        const Grain& other = grains[static_cast<std::size_t>(near.id[k])];
        const double t = pair_time<has_gravity>(grain, other, shift, gravity, limit);
        if (t < first.time) first = {t, near.id[k]};
    }
    return first.partner >= 0 ? first : Contact{};
}

template <bool has_gravity>
void finds_what_pair_time_finds(double gravity, bool is_shifted) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> limit_of(0.5, 1.5);
    const ContactSearch search = contact_search<has_gravity>();
    int met = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const std::vector<Grain> grains = neighbourhood(random);
        const double limit = limit_of(random);
        Candidates near;
        near.count = grains.size();
        near.is_shifted = is_shifted;
        for (std::size_t j = 0; j < grains.size(); ++j) {
            near.id[j] = static_cast<std::int32_t>(j);
            near.shift_x[j] = j % 3 == 0 ? 0.25 : 0;
            near.shift_y[j] = j % 4 == 0 ? -0.5 : 0;
            near.shift_z[j] = j % 5 == 0 ? 0.125 : 0;
        }
        const Contact expected = one_by_one<has_gravity>(grains[0], grains, gravity, limit, near);
        const Contact found = search(grains[0], grains.data(), gravity, limit, near);
        ASSERT_EQ(found.partner, expected.partner) << "trial " << trial;
        ASSERT_EQ(found.time, expected.time) << "trial " << trial;
        met += found.partner >= 0;
    }
    EXPECT_GT(met, 10000);  // the comparison was of something
}

// Each test runs with all instruction sets of the processor, down to one lane.
class FirstContactTest : public ::testing::TestWithParam<std::int64_t> {
 protected:
    void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
    void TearDown() override {
        hwy::SetSupportedTargetsForTest(0);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
};

INSTANTIATE_TEST_SUITE_P(Targets, FirstContactTest,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(FirstContactTest, IsThatOfPairTimeOneByOne) {
    finds_what_pair_time_finds<false>(0, false);
}

TEST_P(FirstContactTest, IsThatOfPairTimeOneByOneUnderGravity) {
    finds_what_pair_time_finds<true>(1, false);
}

TEST_P(FirstContactTest, OfImagesIsThatOfPairTimeWithTheirShifts) {
    finds_what_pair_time_finds<false>(0, true);
    finds_what_pair_time_finds<true>(1, true);
}

TEST_P(FirstContactTest, OfNobodyIsNone) {
    const Grain grain{};
    Candidates near;
    const Contact contact = contact_search<false>()(grain, &grain, 0, 1, near);
    EXPECT_EQ(contact.partner, -1);
    EXPECT_EQ(contact.time, never);
}

// Seven grains, four on one side and three on the other, touch another one at the same time. Those
// that come before them recede. So the first of the seven is in any lane, and others before its
// lane.
TEST_P(FirstContactTest, OfSeveralAtOneTimeIsTheFirstInTheirOrder) {
    constexpr std::size_t meeting = 7;
    for (std::size_t receding = 0; receding < 9; ++receding) {
        std::vector<Grain> grains(1 + receding + meeting);
        Candidates near;
        for (std::size_t k = 1; k < grains.size(); ++k) {
            const double side = k % 2 == 0 ? 1 : -1;
            grains[k].r = {1.5 * side, 0, 0};
            grains[k].v = {k <= receding ? side : -side, 0, 0};
            near.id[near.count++] = static_cast<std::int32_t>(k);
        }
        const Contact contact = contact_search<false>()(grains[0], grains.data(), 0, 1, near);
        EXPECT_EQ(contact.partner, static_cast<std::int32_t>(receding + 1));
        EXPECT_EQ(contact.time, 0.5);
    }
}

}  // namespace
}  // namespace grainfield::simulate
