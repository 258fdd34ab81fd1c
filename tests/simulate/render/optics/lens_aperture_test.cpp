#include "simulate/render/optics/lens_aperture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "simulate/render/optics/silhouette.h"
#include "tests/simulate/render/render_scenes.h"

namespace grainfield::simulate {
namespace {

TEST(Lens, WithoutAnApertureIsItsMiddle) {
    const std::vector<Vec2> points = lens_points(0);
    ASSERT_EQ(points.size(), 1);
    EXPECT_EQ(points[0].x, 0);
    EXPECT_EQ(points[0].y, 0);
}

// Of a disc of radius R: mean square distance R²/2.
TEST(Lens, HasTheSecondMomentOfADisc) {
    const double radius = std::tan(0.1);
    double squares = 0;
    Vec2 mean;
    const std::vector<Vec2> points = lens_points(0.1);
    for (const Vec2 p : points) {
        EXPECT_LT(norm(p), radius);
        squares += squared_norm(p) / static_cast<double>(points.size());
        mean += (1 / static_cast<double>(points.size())) * p;
    }
    EXPECT_NEAR(squares, radius * radius / 2, 1e-12);
    EXPECT_LT(norm(mean), 0.06 * radius);
}

View view_with(double aperture, Projection projection) {
    ViewOptions options;
    options.width = options.height = 121;
    options.projection = projection;
    options.distance = 200;
    options.aperture = aperture;
    return {options, square_box(3), 1.94};
}

// Mean square distance of the darkness from its own centre [a²].
double second_moment(double z, const View& view) {
    SphereScene scene;
    scene.high_plate = 1.94;
    scene.centre = {{1.5, 1.5, z}};
    SilhouetteOptics optics({}, 1);
    const Image image = optics.radiance(scene, view);
    double dark = 0;
    double x_sum = 0;
    double y_sum = 0;
    double squares = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const double darkness = 1 - static_cast<double>(image(x, y));
            dark += darkness;
            x_sum += darkness * x;
            y_sum += darkness * y;
            squares += darkness * (x * x + y * y);
        }
    }
    const double mean_x = x_sum / dark;
    const double mean_y = y_sum / dark;
    const double scale = view.scale();
    return (squares / dark - mean_x * mean_x - mean_y * mean_y) / (scale * scale);
}

TEST(Lens, LeavesWhatIsInFocusAsItIs) {
    EXPECT_NEAR(second_moment(0.97, view_with(0.3, Projection::telecentric)),
                second_moment(0.97, view_with(0, Projection::telecentric)), 1e-9);
}

// Second moments of a convolution add: a sphere h out of focus is blurred by the disc of radius
// h tan α, whose second moment is half the square of that. The points of the lens have that moment
// but for the square of their mean, 0.3 %.
TEST(Lens, BlursASphereOutOfFocusByTheDiscOfItsAperture) {
    for (const double z : {0.5, 1.44}) {
        const double sharp = second_moment(z, view_with(0, Projection::telecentric));
        const double blurred = second_moment(z, view_with(0.3, Projection::telecentric));
        const double radius = std::abs(z - 0.97) * std::tan(0.3);
        EXPECT_NEAR(blurred - sharp, radius * radius / 2, 0.005 * radius * radius) << z;
    }
}

TEST(Lens, MovesASphereAboveFocusAgainstThePoint) {
    SphereScene scene;
    scene.centre = {{1, 1, 1.47}, {1, 1, 0.47}};
    const SphereScene seen =
        seen_through(scene, {0.1, -0.2}, view_with(0.3, Projection::telecentric));
    EXPECT_NEAR(seen.centre[0].x, 0.95, 1e-12);
    EXPECT_NEAR(seen.centre[0].y, 1.1, 1e-12);
    EXPECT_NEAR(seen.centre[1].x, 1.05, 1e-12);
    EXPECT_NEAR(seen.centre[1].y, 0.9, 1e-12);
    EXPECT_EQ(seen.centre[0].z, 1.47);
}

}  // namespace
}  // namespace grainfield::simulate
