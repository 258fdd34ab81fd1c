#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "simulate/render/optics/mirror_cell.h"
#include "simulate/render/optics/optics.h"
#include "simulate/render/optics/raytrace_options.h"
#include "simulate/render/optics/silhouette.h"

namespace grainfield::simulate {

/// What a row of pixels took.
struct RowCost {
    std::int64_t rays = 0;
    std::int64_t samples = 0;
    std::int64_t settled = 0;    ///< pixels that see only the panel
    std::int64_t unsettled = 0;  ///< pixels with more than one sample
    std::int64_t unsettled_samples = 0;
};

/// Mirror-like steel spheres between two glass plates above a diffuse panel, ray by ray.
///
/// A ray from the camera that meets a sphere is reflected as from a mirror, weakened by the
/// reflectance of steel (metal_reflectance). One that meets a plate is split into what passes and
/// what the plate reflects (plate_reflectance), as if at its inner face. What passes downwards sees
/// the panel, radiance ∝ cos^(power − 1) of its angle, within panel_half_size of the frame's
/// middle, after refraction in the glass. What passes upwards sees the LED ring (4° wide) or
/// darkness. Paths end after `bounces` mirrors or below 1 % of weight. Radiance is relative to the
/// unobstructed panel seen straight down. Neglected: roughness, polarisation along a path, the
/// ghost of the plates' outer faces being displaced, light that reaches the panel from spheres.
///
/// Sampling: pixels that no disc touches are the panel as seen through their middle, without a ray.
/// That leaves out what the low plate mirrors into the open field: at most 8 % of what
/// near-vertical rays find above, which is darkness but for a sphere's underside within 0.2 a of
/// its rim, seen obliquely at the border of a perspective frame. Of the others, those that are
/// covered wholly get one ray, at a point of the R2 sequence (`roberts2018`). A pixel then has
///
///   n = ⌈2 σ sqrt(1 − open)/(tolerance · s(b))⌉ samples, at most `most_samples`,
///   s(b) = sqrt((0.06 + b)/1.06),
///
/// σ: standard deviation of the rays of the 24 pixels around it, b: the brightness there, s(b): how
/// the camera's noise falls in the dark, where an error is seen sooner. For a given number of rays
/// the error is least with n ∝ σ (Neyman allocation). A pixel's own value has no say, which keeps
/// the mean right. The share of a pixel that spheres cover comes from SilhouetteOptics, exact but
/// for the disc that stands for an ellipse there. Samples only average over the covered part.
/// Motion blur costs no further rays: each one sees one of the instants. A tolerance of 0 samples
/// every pixel alike with `most_samples` rays and takes plain means: the reference.
///
/// Intersections by Embree (`wald2014`), hit points and normals recomputed in double. Time is
/// about 0.3 µs a ray and core. Same bits for any number of threads.
class RaytraceOptics : public Optics {
 public:
    RaytraceOptics(const RaytraceOptions& options, int threads);
    ~RaytraceOptics() override;

    using Optics::radiance;
    Image radiance(std::span<const SphereScene> instants, const View& view) override;
    OpticsCost cost() const override { return cost_; }

 private:
    void add_cost(double pixels, const RowCost& cost);

    RaytraceOptions options_;
    int threads_;
    OpticsCost cost_;
    SilhouetteOptics silhouette_;
    std::unique_ptr<EmbreeDevice> device_;
};

/// RaytraceOptics among the optics to choose from.
class Raytrace final : public OpticsKindOf<Raytrace>, public RaytraceOptions {
 public:
    std::string name() const override { return "raytrace"; }
    std::string meaning() const override { return "mirror spheres traced ray by ray"; }
    std::string title() const override { return "ray tracing"; }
    OptionTable describe() override;
    void require_valid() const override;
    std::unique_ptr<Optics> make(double noise, int threads) const override;
    void explain(double noise, RunPlan& plan) const override;
    bool samples() const override { return true; }
    void settle(double noise) override { tolerance = sampling_tolerance(*this, noise); }
    /// Uniform sampling, 32 samples or more in every pixel.
    bool become_reference() override;
};

}  // namespace grainfield::simulate
