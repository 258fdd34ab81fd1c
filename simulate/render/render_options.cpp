#include "simulate/render/render_options.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::simulate {

namespace {

OptionTable describe(ViewOptions& o) {
    OptionTable t("view");
    t.integer("width", o.width, "px", {1, 65535}, "width of the frame");
    t.integer("height", o.height, "px", {1, 65535}, "height of the frame");
    t.number("scale", o.scale, "px", {0.5, 10000}, "pixels per diameter; auto: the box fills it");
    t.choice("projection", o.projection,
             {{"perspective", Projection::perspective}, {"telecentric", Projection::telecentric}},
             "rays from a pinhole, or parallel ones");
    t.number("distance", o.distance, "a", {100, 1e6}, "distance of the pinhole from mid height");
    t.number("aperture", o.aperture, "rad", {0, 0.5},
             "half angle of the lens, focused on mid height; 0: all is sharp");
    t.number("centre-x", o.centre_x, "a", {-1e6, 1e6}, "centre of the frame; auto: of the box");
    t.number("centre-y", o.centre_y, "a", {-1e6, 1e6}, "centre of the frame; auto: of the box");
    t.number("cell-height", o.cell_height, "a", {1, 1000},
             fmt::format("distance between the plates; auto: of the trajectory, else {:g}",
                         default_cell_height));
    t.number("sphere-mm", o.sphere_mm, "mm", {1e-3, 1000}, "true diameter a, sets the clock of MD");
    return t;
}

OptionTable describe(ExposureOptions& o) {
    OptionTable t("exposure");
    t.number("time-ms", o.time_ms, "ms", {0, 1e5}, "shutter time, centred on the snapshot");
    t.integer("sub-frames", o.sub_frames, "-", {1, 1000}, "instants averaged, at most");
    t.number("frame-rate", o.frame_rate, "1/s", {1e-6, 1e9},
             "frames per second; auto: one frame a snapshot");
    t.number("drop-rate", o.drop_rate, "-", {0, 1}, "share of frames that the camera loses");
    t.number("jitter", o.jitter, "px", {0, 1000}, "rms shift of the camera per axis and frame");
    return t;
}

OptionTable describe(LightOptions& o) {
    OptionTable t("light");
    t.number("level", o.level, "-", {1e-6, 1000}, "bright field / full well; > 1 saturates");
    t.number("falloff", o.falloff, "-", {0, 1},
             "quadratic fall of the panel's light from centre to corner");
    t.flag("vignetting", o.vignetting, "light falls with cos⁴ of the field angle");
    t.number("gradient", o.gradient, "-", {0, 1}, "linear fall of the light across the frame");
    t.number("gradient-angle", o.gradient_angle, "deg", {-360, 360}, "direction of that fall");
    t.number("stray", o.stray, "-", {0, 1}, "stray light over the frame / bright field");
    t.integer("dust", o.dust, "-", {0, 100000}, "number of dark specks");
    t.number("blur", o.blur, "a", {0, 10}, "σ of the Gaussian point spread");
    return t;
}

OptionTable describe(SensorOptions& o) {
    OptionTable t("sensor");
    t.integer("bits", o.bits, "-", {8, 16}, "bits of a count: 8, 10, 12 or 16");
    t.number("full-well", o.full_well, "e-", {1, 1e9}, "electrons at saturation");
    t.number("read-noise", o.read_noise, "e-", {0, 1e6}, "read noise, rms");
    t.number("offset", o.offset, "DN", {0, 65535}, "dark level");
    t.number("gain", o.gain, "DN/e-", {1e-9, 1e6}, "gain; auto: full well is full scale");
    t.number("prnu", o.prnu, "-", {0, 0.3}, "fixed pattern of the response, rms");
    t.number("dsnu", o.dsnu, "e-", {0, 1e6}, "fixed pattern of the dark level, rms");
    t.number("defects", o.defects, "-", {0, 0.1},
             "share of dead pixels, and the same share of hot ones");
    return t;
}

}  // namespace

std::vector<OptionTable> describe(RenderOptions& o) {
    OptionTable t("");
    o.optics.describe_choice(t);
    t.choice("camera", o.camera, {{"noisy", CameraKind::noisy}, {"ideal", CameraKind::ideal}},
             "ideal: even light, no noise, dust, defects, jitter or lost frames");
    std::vector<OptionTable> tables{t, describe(o.view), describe(o.exposure), describe(o.light),
                                    describe(o.sensor)};
    for (OptionTable& table : o.optics.describe()) tables.push_back(std::move(table));
    return tables;
}

double bright_field_noise(const RenderOptions& o) {
    const double electrons = o.light.level * o.sensor.full_well;
    return (electrons + o.sensor.read_noise * o.sensor.read_noise) / (electrons * electrons);
}

RenderOptions RenderOptions::effective() const {
    RenderOptions o = *this;
    if (view.projection == Projection::telecentric) o.light.vignetting = false;
    if (camera == CameraKind::noisy) return o;
    o.light.falloff = 0;
    o.light.gradient = 0;
    o.light.vignetting = false;
    o.light.stray = 0;
    o.light.dust = 0;
    o.sensor.read_noise = 0;
    o.sensor.prnu = 0;
    o.sensor.dsnu = 0;
    o.sensor.defects = 0;
    o.exposure.drop_rate = 0;
    o.exposure.jitter = 0;
    return o;
}

void require_valid(const RenderOptions& o) {
    const int bits = o.sensor.bits;
    if (bits != 8 && bits != 10 && bits != 12 && bits != 16) {
        throw OptionError({.problem = "sensor.bits: no such sensor",
                           .actual = fmt::format("{} bit", bits),
                           .expected = "8, 10, 12 or 16",
                           .suggestion = {}});
    }
    const double full_scale = std::exp2(bits) - 1;
    if (!(o.sensor.offset < full_scale)) {
        throw OptionError({.problem = "sensor.offset: leaves nothing for the signal",
                           .actual = fmt::format("{:g} DN", o.sensor.offset),
                           .expected = fmt::format("less than {:g}, the full scale", full_scale),
                           .suggestion = "lower it, or take more sensor.bits"});
    }
    o.optics.chosen().require_valid();
}

}  // namespace grainfield::simulate
