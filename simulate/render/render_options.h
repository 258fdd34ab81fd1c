#pragma once

#include <optional>
#include <vector>

#include "core/option_table.h"
#include "simulate/render/optics/optics_choice.h"
#include "simulate/render/projection.h"

namespace grainfield::simulate {

enum class CameraKind { noisy, ideal };

/// When the shutter is open. Section `exposure`.
struct ExposureOptions {
    double time_ms = 0.5;              ///< centred on the instant of the snapshot [ms]
    int sub_frames = 5;                ///< at most; fewer where nothing moves that far
    std::optional<double> frame_rate;  ///< [1/s]; auto: one frame a snapshot
    double drop_rate = 0;              ///< probability that a frame is lost [-]
    double jitter = 0;                 ///< shift of the camera, rms per axis and frame [px]
};

/// The light on its way to the sensor. Section `light`.
struct LightOptions {
    double level = 0.85;        ///< bright field at its brightest / full well; > 1 saturates
    double falloff = 0.10;      ///< of the panel, quadratic, centre to corner [-]
    bool vignetting = true;     ///< cos⁴ of the field angle (none if telecentric)
    double gradient = 0;        ///< linear fall across the frame [-]
    double gradient_angle = 0;  ///< direction in which it falls, from +x to +y [deg]
    double stray = 0.03;        ///< veil over the whole frame / bright field [-]
    int dust = 20;              ///< blurred dark specks, 0.2–1 a, transmission 0.5–0.9
    double blur = 0.08;         ///< σ of the Gaussian point spread [a]
};

/// The sensor, in the terms of EMVA 1288. Section `sensor`.
struct SensorOptions {
    int bits = 8;                ///< 8, 10, 12 or 16
    double full_well = 10000;    ///< electrons at saturation
    double read_noise = 10;      ///< rms [e-]
    double offset = 4;           ///< dark level [DN]
    std::optional<double> gain;  ///< K [DN/e-]; auto: full well is full scale
    double prnu = 0.003;         ///< fixed pattern of the response, rms [-]
    double dsnu = 0;             ///< fixed pattern of the dark level, rms [e-]
    double defects = 1e-5;       ///< share of pixels that are dead, and again that are hot [-]
};

/// Everything about rendered frames.
struct RenderOptions {
    OpticsChoice optics;
    CameraKind camera = CameraKind::noisy;
    ViewOptions view;
    ExposureOptions exposure;
    LightOptions light;
    SensorOptions sensor;

    /// What `camera` makes of light, sensor and exposure: of the ideal one, even light without
    /// stray light and dust, no noise, no fixed pattern, no defects, no lost frames, no jitter.
    /// Blur, exposure, level, offset, gain, saturation and quantisation remain.
    RenderOptions effective() const;
};

/// Variance of the noise of the camera's bright field / its square [-]: what optics that sample may
/// leave unsettled.
double bright_field_noise(const RenderOptions& options);

/// `optics` and `camera` stand in the empty section, then one table a stage and one an optics.
std::vector<OptionTable> describe(RenderOptions& options);

/// Throws OptionError where single fields are in range but do not go together.
void require_valid(const RenderOptions& options);

}  // namespace grainfield::simulate
