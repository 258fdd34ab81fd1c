#pragma once

#include <optional>
#include <vector>

#include "core/option_table.h"

namespace grainfield::simulate {

enum class OpticsKind { silhouette, raytrace };
enum class CameraKind { noisy, ideal };
enum class Projection { perspective, telecentric };

/// Where the camera stands and how large its frame is. Section `view`.
struct ViewOptions {
    int width = 1600;             ///< [px]
    int height = 1600;            ///< [px]
    std::optional<double> scale;  ///< pixels per diameter at mid height; auto: the box fills it
    Projection projection = Projection::perspective;
    double distance = 700;           ///< of the pinhole above mid height [a]; perspective only
    std::optional<double> centre_x;  ///< of the frame [a]; auto: centre of the box
    std::optional<double> centre_y;
    std::optional<double> cell_height;  ///< between the plates [a]; auto: of the trajectory
    double sphere_mm = 1;               ///< a in millimetres: joins simulated time to seconds
};

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

/// Spheres as opaque discs. Section `silhouette`.
struct SilhouetteOptions {
    double rim = 0;  ///< brightness of the ring outside R/√2 that mirrors the backlight [-]
};

/// Steel spheres between glass plates over a panel. Section `raytrace`.
struct RaytraceOptions {
    double panel_distance = 20;   ///< of the diffuser below the low plate's upper face [a]
    double panel_half_size = 75;  ///< of the square panel [a]
    double emission_power = 1;    ///< panel radiance ∝ cos^(power − 1): 1 is Lambertian
    double glass_thickness = 10;  ///< of either plate [a]; 0: no plates
    double ring_level = 0;        ///< radiance of an LED ring above / of the panel; 0: none
    double ring_angle = 30;       ///< of the ring from the vertical, as seen from the cell [deg]
    int bounces = 4;              ///< mirror reflections followed
    bool neighbours = true;       ///< spheres mirror one another; else each only panel and ring
    int most_samples = 16;        ///< rays from the camera per pixel, at most
    /// Twice the standard deviation around a pixel for which one more ray is spent, where it is
    /// bright [bright field]; 0: no ray is spared; auto: of the camera's noise
    /// (sampling_tolerance).
    std::optional<double> tolerance;
};

/// Everything about rendered frames.
struct RenderOptions {
    OpticsKind optics = OpticsKind::silhouette;
    CameraKind camera = CameraKind::noisy;
    ViewOptions view;
    ExposureOptions exposure;
    LightOptions light;
    SensorOptions sensor;
    SilhouetteOptions silhouette;
    RaytraceOptions raytrace;

    /// What `camera` makes of light, sensor and exposure: of the ideal one, even light without
    /// stray light and dust, no noise, no fixed pattern, no defects, no lost frames, no jitter.
    /// Blur, exposure, level, offset, gain, saturation and quantisation remain.
    RenderOptions effective() const;
};

/// The tolerance of ray tracing: as given, else in proportion to the variance of the noise of the
/// camera's bright field: the error of sampling, which goes as the root of it, then follows the
/// noise until most_samples or pixels with a single ray limit it.
double sampling_tolerance(const RenderOptions& options);

/// `optics` and `camera` stand in the empty section, then one table a stage.
std::vector<OptionTable> describe(RenderOptions& options);

/// Throws OptionError where single fields are in range but do not go together.
void require_valid(const RenderOptions& options);

}  // namespace grainfield::simulate
