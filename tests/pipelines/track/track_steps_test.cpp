#include "pipelines/track/track_steps.h"

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

TEST(LabOf, TheFilesSizeOfAPixelGivesMillimetresWhereNothingElseDoes) {
    TrajectoryInfo info;
    info.diameter = 10;
    info.diameter_origin = DiameterOrigin::given;
    Film film;
    EXPECT_FALSE(lab_of({}, std::nullopt, film, info).sphere_mm);
    film.pixel_mm = 0.0065;
    EXPECT_DOUBLE_EQ(lab_of({}, std::nullopt, film, info).sphere_mm.value_or(0), 0.065);
    LabUnits given;
    given.sphere_mm = 1;
    EXPECT_EQ(lab_of(given, std::nullopt, film, info).sphere_mm, 1.0) << "as given";
    tracking::Camera camera;
    camera.scale = {.length = 0.2, .unit = tracking::PlaneUnit::mm};
    EXPECT_DOUBLE_EQ(lab_of({}, camera, film, info).sphere_mm.value_or(0), 2) << "measured";
    camera.scale.reset();
    EXPECT_FALSE(lab_of({}, camera, film, info).sphere_mm) << "its pixels are other ones";
}

TEST(LabOf, TheApparentDiameterIsNoTrueOneInMillimetres) {
    TrajectoryInfo info;
    info.diameter = 10;
    info.diameter_origin = DiameterOrigin::apparent;
    Film film;
    film.pixel_mm = 0.0065;
    EXPECT_FALSE(lab_of({}, std::nullopt, film, info).sphere_mm);
    tracking::Camera camera;
    camera.scale = {.length = 0.2, .unit = tracking::PlaneUnit::mm};
    EXPECT_FALSE(lab_of({}, camera, film, info).sphere_mm);
    LabUnits given;
    given.sphere_mm = 1;
    EXPECT_EQ(lab_of(given, camera, film, info).sphere_mm, 1.0) << "as given";
}

}  // namespace
}  // namespace grainfield::pipelines
