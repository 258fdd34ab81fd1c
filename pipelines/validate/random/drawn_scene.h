#pragma once

#include <cstdint>
#include <optional>

#include "simulate/md/md_options.h"
#include "simulate/render/render_options.h"

namespace grainfield::pipelines {

/// How many spheres a random scene has.
enum class SceneSize {
    small,  ///< 250 to 500: a scene takes seconds
    full,   ///< 1,000 to 3,000
};

/// A square crystal in the middle of a layer.
struct DrawnCrystal {
    double share = 0.3;     ///< of the area of the layer [-]
    double spacing = 0.81;  ///< of its projected square lattice [a]
    double periods = 10;    ///< the picture is taken in the last of them; after many it has melted

    friend bool operator==(const DrawnCrystal&, const DrawnCrystal&) = default;
};

/// A camera and a layer as they are drawn at random: everything else of a scene follows.
struct DrawnScene {
    double panel_distance = 10;      ///< of the panel below the low plate's upper face [a]
    double reflectivity = 0.65;      ///< of a sphere met straight on [-]
    double blur = 0.07;              ///< σ of the point spread [a]
    double aperture = 0.02;          ///< half angle of the lens [rad]
    std::optional<double> distance;  ///< of the pinhole [sides of the frame]; empty: telecentric
    double vignetting = 0.1;         ///< fall of the light from the middle to the corners [-]
    double level = 1.08;             ///< bright field / saturation
    double noise = 0.01;             ///< photon noise of the bright field / bright field
    double stray = 0.03;             ///< stray light / bright field
    double scale = 16;               ///< [px/a]
    double density = 1.17;           ///< spheres per area of the cell [1/a²]
    std::int64_t spheres = 2000;     ///< in the cell
    double amplitude = 0.184;        ///< of the vibration [a]
    double phase = 0;                ///< of the vibration when the picture is taken [periods]
    std::optional<DrawnCrystal> crystal;  ///< empty: liquid all over
    bool walls_seen = true;               ///< the frame reaches 2 a beyond the walls; else 2 a less
    std::uint64_t seed = 1;               ///< of molecular dynamics and noise

    friend bool operator==(const DrawnScene&, const DrawnScene&) = default;
};

/// Camera and layer number `index` of the series of `seed`; depends on nothing else. Uniform unless
/// said: panel 2–30 a (logarithmic), reflectivity .5–.9, blur .04–.12 a, aperture 0–.04 rad, two of
/// three cameras with a pinhole 30–300 sides above (uniform in 1/distance), vignetting 0–.3, level
/// 1–1.1, noise .5–5 % (logarithmic), stray light 0–.05, scale 8–24 px/a (logarithmic), density
/// .9–1.2 per a², spheres by `size` (logarithmic), amplitude .08–.2 a, any phase, walls in sight or
/// not.
///
/// A share `crystals` of the layers has a crystal, on .1–.5 of the area and of spacing .76–.86 a.
/// The liquid beyond 1 a from it has .5–.65 spheres per a². The picture is taken in the first to
/// tenth period (logarithmic, rounded). Density, start and length of these layers follow from that;
/// cameras and other layers are the same.
DrawnScene draw_scene(std::uint64_t seed, std::int64_t index, SceneSize size, double crystals = 0);

/// The layer: steel spheres between plates 1.94 a apart and hard walls, shaken at the experiment's
/// frequency for 40 periods [castillo2019]; one snapshot, at the drawn phase. A crystal is shaken
/// for the periods drawn.
simulate::MdOptions layer_of(const DrawnScene& drawn);

/// The camera: ray-traced, clear plates, an instant of exposure, eight bits. Read noise is a tenth
/// of the photon noise of the bright field.
simulate::RenderOptions camera_of(const DrawnScene& drawn);

}  // namespace grainfield::pipelines
