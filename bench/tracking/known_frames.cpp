#include "bench/tracking/known_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/run_plan.h"
#include "core/support/random.h"
#include "core/trajectory.h"
#include "simulate/render/renderer.h"
#include "tests/support/layer_frames.h"

namespace grainfield::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr double kStep = 0.05;  // of the liquid from frame to frame, per axis [D]
constexpr std::uint64_t kAll = 1;
constexpr std::uint64_t kCrystal = 2;

testing::CrystalPatch patch_of(const FrameSpec& spec) {
    testing::CrystalPatch patch;
    patch.radius = 0.3;
    patch.spacing = spec.density;
    patch.clearance = 1;
    return patch;
}

testing::LayerScene scene_of(const FrameSpec& spec) {
    const int n = spec.pixels();
    const double d = spec.diameter;
    switch (spec.matter) {
        case Matter::isolated:
            return testing::isolated_discs(n, n, d, 2 * d, kSeed);
        case Matter::liquid:
            return testing::hard_disc_liquid(n, n, d, spec.density, kSeed);
        case Matter::patch:
            break;
    }
    return testing::crystal_in_liquid(n, n, d, 0.72, patch_of(spec), kSeed);
}

/// The scene after one frame.
testing::LayerScene moved(const testing::LayerScene& scene, const FrameSpec& spec) {
    if (spec.matter == Matter::isolated) {
        testing::LayerScene next = scene;
        RandomStream random(kSeed, "bench step");
        for (Vec2& p : next.position) {
            p += kStep * scene.diameter * Vec2{random.normal(), random.normal()};
        }
        return next;
    }
    // Three attempted moves a frame, uniform in ±step: √3 · step/√3 if all were accepted.
    testing::LayerMotion motion(scene, patch_of(spec), kStep * scene.diameter, kSeed);
    motion.advance();
    return motion.scene();
}

simulate::RenderOptions render_options(const FrameSpec& spec) {
    simulate::RenderOptions o;
    o.view.width = spec.pixels();
    o.view.height = spec.pixels();
    o.view.scale = spec.diameter;
    o.light.dust = 0;
    o.light.blur = spec.edge * std::sqrt(2 / std::numbers::pi);
    o.exposure.time_ms = 1;
    o.exposure.sub_frames = 9;
    // A contrast of C electrons: half of it is C/2 of shot noise, and as much again of read noise.
    const double contrast = 1 / (spec.noise * spec.noise);
    const double bright = contrast / (1 - o.light.stray);
    o.sensor.full_well = bright / o.light.level;
    const double shot = bright * o.light.stray + contrast / 2;
    o.sensor.read_noise = std::sqrt(std::max(0.0, contrast - shot));
    return o;
}

struct Rendered {
    Image counts;
    Snapshot truth;
};

Rendered silhouettes(const testing::LayerScene& scene, const FrameSpec& spec, std::int64_t index) {
    Snapshot snapshot;
    snapshot.box = {{-0.5, -0.5},
                    {static_cast<double>(scene.width), static_cast<double>(scene.height)}};
    snapshot.position = scene.position;
    snapshot.layer = scene.layer;
    const simulate::RenderOptions options = render_options(spec);
    RandomStream random(kSeed, "bench velocity");
    const double speed = spec.path * spec.diameter / (1e-3 * options.exposure.time_ms);
    for (std::size_t i = 0; i < scene.position.size(); ++i) {
        snapshot.id.push_back(static_cast<std::int64_t>(i));
        if (spec.path > 0) {
            snapshot.velocity.push_back({speed * random.normal(), speed * random.normal(), 0});
        }
    }
    TrajectoryInfo info;
    info.length_unit = LengthUnit::pixel;
    info.time_unit = TimeUnit::second;
    info.diameter = spec.diameter;
    RunPlan plan;
    simulate::Renderer renderer(options, info, snapshot.box, kSeed, 2, plan);
    simulate::RenderedFrame rendered = renderer.render(snapshot, index);
    return {std::move(rendered.frame.image), std::move(rendered.truth)};
}

void classify(KnownFrame& frame, const Snapshot& truth, std::size_t crystal_begin, double border) {
    frame.truth.position = truth.position;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Vec2 p = truth.position[i];
        const double inside =
            std::min({p.x, p.y, frame.counts.width() - 1 - p.x, frame.counts.height() - 1 - p.y});
        const bool in_crystal = static_cast<std::size_t>(truth.id[i]) >= crystal_begin;
        frame.truth.classes.push_back(inside < border ? 0 : in_crystal ? kAll | kCrystal : kAll);
    }
}

}  // namespace

std::string FrameSpec::scene() const {
    switch (matter) {
        case Matter::isolated:
            return "isolated";
        case Matter::liquid:
            return fmt::format("liquid {:g}", density);
        case Matter::patch:
            break;
    }
    return fmt::format("patch {:g}", density);
}

int FrameSpec::pixels() const {
    return static_cast<int>(std::lround(side * diameter));
}

KnownFrame make_frame(const FrameSpec& spec) {
    const testing::LayerScene before = scene_of(spec);
    const testing::LayerScene now = moved(before, spec);
    KnownFrame frame;
    Snapshot truth;
    if (spec.camera == CameraModel::own) {
        const double w = spec.edge * spec.diameter;
        frame.before = testing::tanh_frame(before, spec.diameter, w, spec.noise, 1);
        frame.counts = testing::tanh_frame(now, spec.diameter, w, spec.noise, 2);
        truth.position = now.position;
        for (std::size_t i = 0; i < now.position.size(); ++i) {
            truth.id.push_back(static_cast<std::int64_t>(i));
        }
    } else {
        frame.before = silhouettes(before, spec, 0).counts;
        Rendered rendered = silhouettes(now, spec, 1);
        frame.counts = std::move(rendered.counts);
        truth = std::move(rendered.truth);
    }
    classify(frame, truth, now.crystal_begin, spec.diameter);
    return frame;
}

}  // namespace grainfield::bench
