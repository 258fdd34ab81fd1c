#pragma once

#include <cmath>

#include "core/support/random.h"
#include "simulate/render/optics/optics.h"

namespace grainfield::simulate {

/// Spheres at random in a slit, overlaps in space allowed: what silhouettes do not mind.
inline SphereScene random_scene(int count, double side, double height, std::uint64_t seed) {
    RandomStream random(seed, "render test scene");
    SphereScene scene;
    scene.high_plate = height;
    for (int i = 0; i < count; ++i) {
        scene.centre.push_back(
            {random.uniform(0, side), random.uniform(0, side), random.uniform(0.5, height - 0.5)});
    }
    return scene;
}

/// A square bilayer of projected spacing `spacing`, layers alternating on the checkerboard.
inline SphereScene crystal_scene(int columns, double spacing, double height) {
    SphereScene scene;
    scene.high_plate = height;
    for (int j = 0; j < columns; ++j) {
        for (int i = 0; i < columns; ++i) {
            scene.centre.push_back(
                {(i + 0.5) * spacing, (j + 0.5) * spacing, (i + j) % 2 == 0 ? 0.5 : height - 0.5});
        }
    }
    return scene;
}

inline Box square_box(double side, Boundary boundary = Boundary::walls) {
    return {{0, 0}, {side, side}, {boundary, boundary}, 1.94};
}

inline View square_view(int pixels, double side, Projection projection) {
    ViewOptions options;
    options.width = pixels;
    options.height = pixels;
    options.projection = projection;
    return {options, square_box(side), 1.94};
}

}  // namespace grainfield::simulate
