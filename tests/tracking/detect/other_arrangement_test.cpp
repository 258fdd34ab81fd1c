#include "tracking/detect/other_arrangement.h"

#include <vector>

#include <gtest/gtest.h>

#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr int kSide = 96;
const DiscProfile kDisc{16, 1.4};

/// The darkness of discs whose transmissions multiply.
Image frame_of(const std::vector<Vec2>& discs) {
    PaddedImage transmission = clear_transmission(kSide, kSide, kDisc);
    place_discs(transmission, discs, kDisc);
    Image darkness(kSide, kSide);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) darkness(x, y) = 1.0F - transmission.row(y)[x];
    }
    return darkness;
}

const std::vector<Vec2> kThree{{36, 48}, {46, 48.5}, {57, 48}};
const std::vector<Vec2> kTwo{{38, 48}, {54, 48}};
const Vec2 kFar{80, 80};

std::vector<Vec2> with_far(std::vector<Vec2> discs) {
    discs.push_back(kFar);
    return discs;
}

TEST(OtherArrangement, DiscsThatBothFoundAreNoDifference) {
    EXPECT_TRUE(compare_arrangements(kThree, kThree, 16, kSide, kSide).differences.empty());
    std::vector<Vec2> near = kThree;
    for (Vec2& p : near) p.x += 2;
    EXPECT_TRUE(compare_arrangements(kThree, near, 16, kSide, kSide).differences.empty());
}

TEST(OtherArrangement, DiscsWithoutPartnersOfOnePlaceAreOneDifference) {
    const auto differences =
        compare_arrangements(with_far(kTwo), with_far(kThree), 16, kSide, kSide).differences;
    ASSERT_EQ(differences.size(), 1U);
    // (38, 48) and (36, 48), (54, 48) and (57, 48) are the same spheres.
    EXPECT_TRUE(differences[0].ours.empty());
    ASSERT_EQ(differences[0].theirs.size(), 1U);
    EXPECT_EQ(differences[0].theirs[0], kThree[1]);
}

TEST(OtherArrangement, AClusterOfMoreThanFortyIsCountedButIsNoDifference) {
    std::vector<Vec2> row;
    for (int i = 0; i < 45; ++i) row.push_back({10.0 + 15 * i, 48});
    const OtherArrangement other = compare_arrangements({}, row, 16, 700, kSide);
    EXPECT_TRUE(other.differences.empty());
    EXPECT_EQ(other.unlike, 45U);
    EXPECT_EQ(other.unlike_in_large, 45U);
}

TEST(OtherArrangement, ThreeFoundAsTwoAreMendedAndTheTrialLeavesNoTrace) {
    const Image darkness = frame_of(with_far(kThree));
    JointFit fit(darkness, kDisc, 1);
    fit.add_all(with_far(kTwo));
    const RefinementOptions refinement;
    fit.refine(refinement);
    const double before = fit.residual_rms();
    std::vector<ArrangementDifference> differences =
        compare_arrangements(fit.positions(), with_far(kThree), 16, kSide, kSide).differences;
    ASSERT_EQ(differences.size(), 1U);
    try_differences(fit, differences, false, refinement);
    EXPECT_LT(differences[0].change, 0);
    EXPECT_EQ(fit.positions().size(), 3U);
    EXPECT_NEAR(fit.residual_rms(), before, 1e-3 * before);

    take_differences(fit, differences, refinement);
    EXPECT_EQ(fit.positions().size(), 4U);
    // Half floats keep the transmissions to 2.4e-4.
    EXPECT_LT(fit.residual_rms(), 1e-3);
}

TEST(OtherArrangement, AWrongArrangementRaisesTheMisfitFromEitherSide) {
    const Image darkness = frame_of(with_far(kThree));
    const RefinementOptions refinement;
    JointFit right(darkness, kDisc, 1);
    right.add_all(with_far(kThree));
    right.refine(refinement);
    // Two discs between the three, where none has a partner.
    const std::vector<Vec2> wrong = with_far({{41, 48}, {51.5, 48}});
    std::vector<ArrangementDifference> differences =
        compare_arrangements(right.positions(), wrong, 16, kSide, kSide).differences;
    ASSERT_FALSE(differences.empty());
    try_differences(right, differences, false, refinement);
    EXPECT_GT(differences[0].change, 0);

    JointFit theirs(darkness, kDisc, 1);
    theirs.add_all(wrong);
    std::vector<ArrangementDifference> reversed =
        compare_arrangements(kThree, wrong, 16, kSide, kSide).differences;
    ASSERT_FALSE(reversed.empty());
    try_differences(theirs, reversed, true, refinement);
    EXPECT_LT(reversed[0].change, 0);
}

}  // namespace
}  // namespace grainfield::tracking
