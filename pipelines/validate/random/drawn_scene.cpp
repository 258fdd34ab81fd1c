#include "pipelines/validate/random/drawn_scene.h"

#include <cmath>

#include "core/support/random.h"
#include "simulate/render/optics/raytrace.h"

namespace grainfield::pipelines {

namespace {

constexpr double cell_height = 1.94;  // [a]
constexpr double beside = 2;          // from the walls to the edges of the frame [a]
constexpr double nearest_pinhole = 30;
constexpr double farthest_pinhole = 300;

double logarithmic(RandomStream& random, double low, double high) {
    return low * std::pow(high / low, random.uniform());
}

/// Of a square cell of so many spheres: those of the crystal, and `liquid` per a² beyond a rim of
/// 1 a around it [1/a²].
double density_with(const DrawnCrystal& crystal, std::int64_t spheres, double liquid) {
    // The crystal takes its share of the cell without a rim of 1 a, which is u wide:
    //   spheres = (q u/spacing)² + liquid ((u + 2)² − (q u + 2)²), q² the share.
    const double q = std::sqrt(crystal.share);
    const double square =
        crystal.share / (crystal.spacing * crystal.spacing) + liquid * (1 - crystal.share);
    const double half = 2 * liquid * (1 - q);
    const auto n = static_cast<double>(spheres);
    const double u = (std::sqrt(half * half + square * n) - half) / square;
    return n / ((u + 2) * (u + 2));
}

double side_of(const DrawnScene& drawn) {
    return std::sqrt(static_cast<double>(drawn.spheres) / drawn.density);
}

}  // namespace

DrawnScene draw_scene(std::uint64_t seed, std::int64_t index, SceneSize size, double crystals) {
    RandomStream random(seed, "validate random optics", static_cast<std::uint64_t>(index));
    DrawnScene drawn;
    drawn.panel_distance = logarithmic(random, 2, 30);
    drawn.reflectivity = random.uniform(0.5, 0.9);
    drawn.blur = random.uniform(0.04, 0.12);
    drawn.aperture = random.uniform(0, 0.04);
    const bool has_pinhole = random.uniform() < 2.0 / 3;
    const double inverse = random.uniform(1 / farthest_pinhole, 1 / nearest_pinhole);
    if (has_pinhole) drawn.distance = 1 / inverse;
    drawn.vignetting = random.uniform(0, 0.3);
    drawn.level = random.uniform(1, 1.1);
    drawn.noise = logarithmic(random, 0.005, 0.05);
    drawn.stray = random.uniform(0, 0.05);
    drawn.scale = logarithmic(random, 8, 24);
    drawn.density = random.uniform(0.9, 1.2);
    drawn.spheres = std::llround(size == SceneSize::small ? logarithmic(random, 250, 500)
                                                          : logarithmic(random, 1000, 3000));
    drawn.amplitude = random.uniform(0.08, 0.2);
    drawn.phase = random.uniform();
    drawn.walls_seen = random.uniform() < 0.5;
    RandomStream crystals_drawn(seed, "validate random crystals",
                                static_cast<std::uint64_t>(index));
    if (crystals_drawn.uniform() < crystals) {
        const DrawnCrystal crystal{.share = crystals_drawn.uniform(0.1, 0.5),
                                   .spacing = crystals_drawn.uniform(0.76, 0.86),
                                   .periods = std::round(logarithmic(crystals_drawn, 1, 10))};
        drawn.crystal = crystal;
        drawn.density = density_with(crystal, drawn.spheres, crystals_drawn.uniform(0.5, 0.65));
    }
    drawn.seed = seed + 1000003 * static_cast<std::uint64_t>(index);
    return drawn;
}

simulate::MdOptions layer_of(const DrawnScene& drawn) {
    simulate::MdOptions md;
    md.cell.grains = drawn.spheres;
    md.cell.length_x = md.cell.length_y = side_of(drawn);
    md.cell.height = cell_height;
    md.cell.sides_x = md.cell.sides_y = simulate::Side::walls;
    md.vibration.amplitude = drawn.amplitude;
    md.vibration.angular_frequency = 5.075;
    md.grain.restitution = 0.95;
    md.grain.tangential_restitution = 0;
    md.grain.static_friction = md.grain.dynamic_friction = 0.3;
    md.plate = md.grain;
    md.run.contact_time = 3e-4;
    md.run.periods = 40;
    md.run.discard = 39;
    md.run.snapshot_every = 1;
    md.run.snapshot_phase = drawn.phase;
    if (drawn.crystal) {
        md.initial.layout = simulate::InitialLayout::square;
        md.initial.crystal_fraction = drawn.crystal->share;
        md.initial.crystal_spacing = drawn.crystal->spacing;
        md.initial.temperature = 0.1;  // as in data-samples/scene-raytrace.toml
        md.run.periods = drawn.crystal->periods;
        md.run.discard = drawn.crystal->periods - 1;
    }
    return md;
}

simulate::RenderOptions camera_of(const DrawnScene& drawn) {
    simulate::RenderOptions render;
    const double side = side_of(drawn) + 2 * (drawn.walls_seen ? beside : -beside);
    render.view.width = render.view.height = static_cast<int>(std::lround(side * drawn.scale));
    render.view.scale = drawn.scale;
    render.view.aperture = drawn.aperture;
    render.view.projection =
        drawn.distance ? simulate::Projection::perspective : simulate::Projection::telecentric;
    if (drawn.distance) render.view.distance = *drawn.distance * side;
    render.view.cell_height = cell_height;
    render.exposure.time_ms = 0;
    render.exposure.sub_frames = 1;
    render.light.level = drawn.level;
    render.light.falloff = drawn.vignetting;
    render.light.vignetting = false;  // the fall above has it
    render.light.stray = drawn.stray;
    render.light.dust = 0;
    render.light.blur = drawn.blur;
    const double electrons = 1 / (drawn.noise * drawn.noise);
    render.sensor.full_well = electrons / drawn.level;
    render.sensor.read_noise = 0.1 * std::sqrt(electrons);
    render.sensor.defects = 0;
    render.optics.select("raytrace");
    auto& raytrace = render.optics.of<simulate::Raytrace>();
    raytrace.panel_distance = drawn.panel_distance;
    raytrace.panel_half_size = 1e4;
    raytrace.glass_thickness = 0;
    raytrace.reflectivity = drawn.reflectivity;
    return render;
}

}  // namespace grainfield::pipelines
