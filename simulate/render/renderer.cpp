#include "simulate/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/random.h"

namespace grainfield::simulate {

namespace {

constexpr double largest_step = 0.25;  // between sub-frames [px]
constexpr double seen_beyond = 4;      // [a] around the frame: what may reflect into it

double cell_height_of(const RenderOptions& options, const TrajectoryInfo& info, const Box& box) {
    if (options.view.cell_height) return *options.view.cell_height;
    return box.height > 0 ? box.height / info.diameter : default_cell_height;
}

Box in_diameters(const Box& box, double diameter) {
    Box scaled = box;
    scaled.origin *= 1 / diameter;
    scaled.length *= 1 / diameter;
    scaled.height /= diameter;
    return scaled;
}

void require_at_most_three_periods(const View& view, const Box& box) {
    const double width = view.width() / view.scale();
    const double height = view.height() / view.scale();
    const bool x = box.boundary[0] == Boundary::periodic && width > 3 * box.length.x;
    const bool y = box.boundary[1] == Boundary::periodic && height > 3 * box.length.y;
    if (!x && !y) return;
    throw OptionError({.problem = "view: the frame shows more than three periods of the box",
                       .actual = fmt::format("{:.4g} × {:.4g} a of {:.4g} × {:.4g} a", width,
                                             height, box.length.x, box.length.y),
                       .expected = "at most three",
                       .suggestion = "raise view.scale, or make the frame smaller"});
}

// Shifts by whole periods, the original first.
std::vector<Vec2> images_of(const Box& box) {
    const auto along = [](Boundary boundary) {
        return boundary == Boundary::periodic ? std::vector<double>{0, -1, 1}
                                              : std::vector<double>{0};
    };
    std::vector<Vec2> shifts;
    for (const double ny : along(box.boundary[1])) {
        for (const double nx : along(box.boundary[0])) {
            shifts.push_back({nx * box.length.x, ny * box.length.y});
        }
    }
    return shifts;
}

bool is_within(Vec2 p, const View& view, double margin) {
    return p.x >= -0.5 - margin && p.x < view.width() - 0.5 + margin && p.y >= -0.5 - margin &&
           p.y < view.height() - 0.5 + margin;
}

void explain_optics(const RenderOptions& o, const View& view, RunPlan& plan) {
    plan.run("optics",
             fmt::format("{}, {} × {} px, {:.4g} px per diameter", o.optics.chosen().title(),
                         view.width(), view.height(), view.scale()));
    o.optics.chosen().explain(bright_field_noise(o), plan);
}

void explain_light(const RenderOptions& o, RunPlan& plan) {
    if (o.camera == CameraKind::ideal) {
        plan.skip("noise", "the camera is ideal", "random numbers, about 5 ms a megapixel");
    } else {
        plan.run("noise", fmt::format("shot noise of {:g} electrons, read noise {:g}",
                                      o.light.level * o.sensor.full_well, o.sensor.read_noise));
    }
    if (o.light.blur > 0) {
        plan.run("blur", fmt::format("Gaussian, σ = {:g} a", o.light.blur));
    } else {
        plan.skip("blur", "σ = 0", "two convolutions a frame");
    }
}

}  // namespace

double shutter_seconds(const RenderOptions& options, double seconds_per_unit) {
    return seconds_per_unit > 0 ? options.exposure.time_ms * 1e-3 : 0;
}

Renderer::Renderer(const RenderOptions& options, const TrajectoryInfo& info, const Box& box,
                   std::uint64_t seed, int threads, RunPlan& plan)
    : options_(options.effective()),
      info_(info),
      height_(cell_height_of(options, info, box)),
      seconds_per_unit_(simulate::seconds_per_unit(info, options)),
      seed_(seed),
      view_(options.view, in_diameters(box, info.diameter), height_),
      camera_(options, view_, seed, threads),
      optics_(options_.optics.chosen().make(bright_field_noise(options_), threads)) {
    require_at_most_three_periods(view_, in_diameters(box, info.diameter));
    explain_optics(options_, view_, plan);
    const double shutter = shutter_seconds(options_, seconds_per_unit_);
    if (shutter > 0 && options_.exposure.sub_frames > 1) {
        plan.run("motion blur", fmt::format("{:g} ms, up to {} instants a frame", shutter * 1e3,
                                            options_.exposure.sub_frames));
    } else {
        plan.skip("motion blur",
                  seconds_per_unit_ > 0 ? "one instant a frame" : "the trajectory has no clock",
                  "the other instants of each frame");
    }
    explain_light(options_, plan);
}

bool Renderer::loses(std::int64_t index) const {
    const double rate = options_.exposure.drop_rate;
    if (rate <= 0) return false;
    return RandomStream(seed_, "render lost frames", static_cast<std::uint64_t>(index)).uniform() <
           rate;
}

TrajectoryInfo Renderer::truth_info() const {
    TrajectoryInfo info;
    info.origin = Origin::rendered;
    info.length_unit = LengthUnit::pixel;
    info.time_unit = seconds_per_unit_ > 0 ? TimeUnit::second : TimeUnit::frame;
    info.diameter = view_.scale();
    info.diameter_origin = DiameterOrigin::simulated;
    info.source = info_.source;
    if (seconds_per_unit_ > 0) {
        info.frame_rate = options_.exposure.frame_rate;
        if (!info.frame_rate && info_.frame_rate) {
            info.frame_rate = *info_.frame_rate / seconds_per_unit_;
        }
        if (info_.vibration_frequency) {
            info.vibration_frequency = *info_.vibration_frequency / seconds_per_unit_;
        }
    }
    return info;
}

std::vector<double> Renderer::instants_of(const GrainMotion& motion) const {
    const double shutter = shutter_seconds(options_, seconds_per_unit_);
    const double path = 3 * motion.lateral_speed() * shutter * view_.scale();
    const int needed = static_cast<int>(std::ceil(std::min(path / largest_step, 1e6)));
    const int n = std::clamp(needed, 1, options_.exposure.sub_frames);
    std::vector<double> instants;
    for (int i = 0; i < n; ++i) instants.push_back(((i + 0.5) / n - 0.5) * shutter);
    return instants;
}

std::vector<SphereScene> Renderer::scenes_at(const GrainMotion& motion, const Box& box,
                                             const std::vector<double>& instants) const {
    std::vector<SphereScene> scenes(instants.size());
    for (SphereScene& scene : scenes) {
        scene.low_plate = 0;
        scene.high_plate = height_;
        scene.centre.reserve(motion.centre.size());
    }
    const double margin = seen_beyond * view_.scale() + camera_.margin() + options_.exposure.jitter;
    for (const Vec2 shift : images_of(box)) {
        for (std::size_t i = 0; i < motion.centre.size(); ++i) {
            // At every instant or at none: the same spheres in the same order.
            const Vec3 place = motion.centre[i] + Vec3{shift.x, shift.y, 0};
            if (!is_within(view_.project(place), view_, margin)) continue;
            for (std::size_t k = 0; k < scenes.size(); ++k) {
                scenes[k].centre.push_back(motion.at(i, instants[k]) + Vec3{shift.x, shift.y, 0});
            }
        }
    }
    return scenes;
}

Renderer::Exposure Renderer::exposure_of(const SnapshotSeries& series, std::int64_t index) const {
    Exposure exposure{
        grain_motion(series, info_, height_, seconds_per_unit_, options_.view.sphere_mm),
        {},
        view_};
    exposure.instants = instants_of(exposure.motion);
    if (options_.exposure.jitter > 0) {
        RandomStream random(seed_, "render jitter", static_cast<std::uint64_t>(index));
        const double x = random.normal();
        const double y = random.normal();
        exposure.view = view_.shifted(options_.exposure.jitter * Vec2{x, y});
    }
    return exposure;
}

Snapshot Renderer::truth_of(const Snapshot& snapshot, const Exposure& exposure,
                            std::int64_t index) const {
    const View& view = exposure.view;
    const GrainMotion& motion = exposure.motion;
    Snapshot truth;
    truth.frame = index;
    truth.time =
        seconds_per_unit_ > 0 ? snapshot.time * seconds_per_unit_ : static_cast<double>(index);
    truth.box = {{-0.5, -0.5},
                 {static_cast<double>(view.width()), static_cast<double>(view.height())},
                 {Boundary::walls, Boundary::walls},
                 height_ * view.scale()};
    const Box box = in_diameters(snapshot.box, info_.diameter);
    const std::int64_t stride =
        snapshot.id.empty() ? 0 : *std::max_element(snapshot.id.begin(), snapshot.id.end()) + 1;
    const double weight = 1 / static_cast<double>(exposure.instants.size());
    std::int64_t image = -1;
    for (const Vec2 shift : images_of(box)) {
        ++image;
        for (std::size_t i = 0; i < motion.centre.size(); ++i) {
            Vec2 seen;
            double z = 0;
            for (const double seconds : exposure.instants) {
                const Vec3 p = motion.at(i, seconds) + Vec3{shift.x, shift.y, 0};
                seen += weight * view.project(p);
                z += weight * p.z;
            }
            if (!is_within(seen, view, 0)) continue;
            truth.position.push_back(seen);
            if (!snapshot.id.empty()) truth.id.push_back(snapshot.id[i] + image * stride);
            if (!motion.velocity.empty()) {
                truth.velocity.push_back(motion.velocity[i] * view.scale());
            }
            if (!motion.has_heights) continue;
            truth.z.push_back(z * view.scale());
            truth.layer.push_back(z > height_ / 2 ? Layer::top : Layer::bottom);
        }
    }
    return truth;
}

Snapshot Renderer::truth(const SnapshotSeries& series, std::int64_t index) const {
    require_at_most_three_periods(view_, in_diameters(series.snapshot().box, info_.diameter));
    return truth_of(series.snapshot(), exposure_of(series, index), index);
}

double Renderer::half_exposure() const {
    if (options_.exposure.sub_frames < 2 || !(seconds_per_unit_ > 0)) return 0;
    return 0.5 * shutter_seconds(options_, seconds_per_unit_) / seconds_per_unit_;
}

Vec2 Renderer::crossing_span(const Box& box) const {
    const Box cell = in_diameters(box, info_.diameter);
    const auto along = [&](Boundary boundary, int pixels, double period) {
        const auto frame = static_cast<double>(pixels);
        return boundary == Boundary::periodic ? std::min(frame, period * view_.scale()) : frame;
    };
    return {along(cell.boundary[0], view_.width(), cell.length.x),
            along(cell.boundary[1], view_.height(), cell.length.y)};
}

RenderedFrame Renderer::render(const SnapshotSeries& series, std::int64_t index) {
    const Snapshot& snapshot = series.snapshot();
    const Box box = in_diameters(snapshot.box, info_.diameter);
    require_at_most_three_periods(view_, box);
    const Exposure exposure = exposure_of(series, index);
    flights_.add(exposure.motion.flights);

    RenderedFrame rendered;
    rendered.sub_frames = static_cast<int>(exposure.instants.size());
    rendered.truth = truth_of(snapshot, exposure, index);
    if (loses(index)) {
        rendered.frame.status = FrameStatus::missing;
        rendered.frame.message = "the camera lost this frame";
        rendered.frame.bit_depth = options_.sensor.bits;
    } else {
        const View fine = camera_.radiance_view(exposure.view);
        const Image radiance =
            optics_->radiance(scenes_at(exposure.motion, box, exposure.instants), fine);
        rendered.frame = camera_.photograph(radiance, index);
    }
    rendered.frame.index = index;
    rendered.frame.time = rendered.truth.time;
    return rendered;
}

}  // namespace grainfield::simulate
