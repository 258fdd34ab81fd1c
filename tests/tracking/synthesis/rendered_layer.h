#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/support/random.h"
#include "tests/support/slit_spheres.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/synthesis/mirror_scene.h"

namespace grainfield::testing {

/// A bilayer of known positions, and a frame of it as MirrorImage renders it.
struct RenderedLayer {
    double scale = 0;   ///< [px/a]
    double height = 0;  ///< of the cell [a]
    std::vector<tracking::Point3> spheres;
    tracking::MirrorOptics optics;
    Image brightness;  ///< 1 on the panel
    Image ceiling;     ///< far above

    bool is_inner(const tracking::Point3& p, double border) const {
        const auto inside = [&](float v, int pixels) {
            return v > static_cast<float>(border) &&
                   v < static_cast<float>((pixels - 1) / scale - border);
        };
        return inside(p.x, brightness.width()) && inside(p.y, brightness.height());
    }
};

/// The frame shows the middle `side` − 2 diameters of a melted bilayer `side` diameters wide.
inline RenderedLayer rendered_layer(double side, double scale, double noise, std::uint64_t seed) {
    constexpr double kHeight = 1.94;
    RenderedLayer layer;
    layer.scale = scale;
    layer.height = kHeight;
    const SlitScene slit = shaken_bilayer(side, kHeight, 0.95, 0.05, 60, seed);
    for (std::size_t i = 0; i < slit.position.size(); ++i) {
        layer.spheres.push_back({static_cast<float>(slit.position[i].x - 1),
                                 static_cast<float>(slit.position[i].y - 1),
                                 static_cast<float>(slit.z[i])});
    }
    const int pixels = static_cast<int>((side - 2) * scale);
    tracking::MirrorImage image(pixels, pixels, scale, 2);
    image.render(tracking::MirrorScene(layer.spheres, layer.optics));
    layer.brightness = image.image();
    RandomStream random(seed, "camera");
    for (float& v : layer.brightness.pixels()) v += static_cast<float>(noise * random.normal());
    layer.ceiling = Image(pixels, pixels, 1e9F);
    return layer;
}

/// The spheres, each displaced by a random vector of these RMS lengths per axis.
inline std::vector<tracking::Point3> displaced(const RenderedLayer& layer, double plane,
                                               double height, std::uint64_t seed) {
    RandomStream random(seed, "displacement");
    std::vector<tracking::Point3> spheres = layer.spheres;
    const auto top = static_cast<float>(layer.height - 1);
    for (tracking::Point3& p : spheres) {
        p.x += static_cast<float>(plane * random.normal());
        p.y += static_cast<float>(plane * random.normal());
        p.z = std::clamp(p.z + static_cast<float>(height * random.normal()), 0.0F, top);
    }
    return spheres;
}

}  // namespace grainfield::testing
