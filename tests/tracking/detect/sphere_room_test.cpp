#include "tracking/detect/sphere_room.h"

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

constexpr int kSize = 120;
constexpr double kA = 16;
constexpr DiscProfile kDisc{14, 1.2};
constexpr SphereCell kCell{.diameter = kA, .height = 1.94};

/// Two spheres, `distance` apart [a], the first one at `middle`.
JointFit two(double distance, Vec2 middle = {60, 60}) {
    JointFit fit(Image(kSize, kSize), kDisc, 1);
    fit.add(middle);
    fit.add(middle + Vec2{distance * kA, 0});
    return fit;
}

BiasCorrection no_bias() {
    BiasCorrection correction;
    correction.diameter = kA;
    correction.weights.assign(BiasTerms::kCount, 0.0);
    return correction;
}

TEST(SphereRoom, NeedsTheLeastDistanceLessWhatIsGranted) {
    const double least = kCell.least_distance();
    const JointFit fit = two(least - 0.05);
    const SphereRoom room(fit, kCell, nullptr);
    EXPECT_TRUE(room.has(0, {.corrected = 0, .fitted = 0.06}));
    EXPECT_FALSE(room.has(0, {.corrected = 1, .fitted = 0.04}));
    const JointFit far = two(1.01);
    EXPECT_TRUE(SphereRoom(far, kCell, nullptr).has(0, {0, 0}));
}

TEST(SphereRoom, IsJudgedBesideThoseThatArePresent) {
    const JointFit fit = two(0.2);
    const SphereRoom room(fit, kCell, nullptr);
    EXPECT_FALSE(room.has(0, {0, 0}));
    EXPECT_FALSE(room.has(0, {0, 0}, {1, 1}));
    EXPECT_TRUE(room.has(0, {0, 0}, {1, 0}));
}

TEST(SphereRoom, GrantsWhatCorrectedPositionsNeedWhereTheCorrectionReaches) {
    const BiasCorrection correction = no_bias();
    const double least = kCell.least_distance();
    const GrantedRoom granted{.corrected = 0.04, .fitted = 0.06};
    const JointFit fit = two(least - 0.05);
    EXPECT_FALSE(SphereRoom(fit, kCell, &correction).has(0, granted));
    EXPECT_TRUE(SphereRoom(fit, kCell, &correction).is_corrected(0));
    EXPECT_FALSE(SphereRoom(fit, kCell, nullptr).is_corrected(0));
    const JointFit at_border = two(least - 0.05, {2, 60});
    EXPECT_FALSE(SphereRoom(at_border, kCell, &correction).is_corrected(0));
    EXPECT_TRUE(SphereRoom(at_border, kCell, &correction).has(0, granted));
}

}  // namespace
}  // namespace grainfield::tracking
