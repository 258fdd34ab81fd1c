#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "simulate/render/optics/disc_scan.h"
#include "simulate/render/optics/optics.h"

namespace grainfield::simulate {

/// Spheres as opaque discs. Section `silhouette`.
struct SilhouetteOptions {
    double rim = 0;  ///< brightness of the ring outside R/√2 that mirrors the backlight [-]
};

/// Spheres as opaque discs before an even backlight, anti-aliased exactly.
///
/// Without a rim, a pixel is 1 − (area of the union of all discs in it): closed form where one
/// circle cuts it (DiscScan), or two (union_of_two, but for a few that touch or cross twice in it);
/// union_area where three overlapping ones do (error below 2e-4 of a pixel from R = 4 px on, 1e-3
/// at 1.5 px). With a rim, each sphere has a dark core of radius R/√2, beyond which it mirrors the
/// backlight with brightness `rim`. Spheres are laid over one another from bottom to top. Coverages
/// of different spheres in one pixel are taken as independent.
///
/// Perspective: the ellipse that a sphere of radius R at depth d, X off the axis, is seen as, is
/// replaced by the disc of its area about its centre: off by less than X²/(4 d²) of the radius.
///
/// O(pixels + grains · diameter). Bands of rows in parallel.
class SilhouetteOptics : public Optics {
 public:
    SilhouetteOptics(const SilhouetteOptions& options, int threads);
    using Optics::radiance;
    Image radiance(std::span<const SphereScene> instants, const View& view) override;
    OpticsCost cost() const override { return cost_; }

 private:
    Image at_one_instant(const SphereScene& scene, const View& view) const;

    SilhouetteOptions options_;
    int threads_;
    OpticsCost cost_;
};

/// SilhouetteOptics among the optics to choose from.
class Silhouette final : public OpticsKindOf<Silhouette>, public SilhouetteOptions {
 public:
    std::string name() const override { return "silhouette"; }
    std::string meaning() const override { return "opaque discs"; }
    std::string title() const override { return "silhouettes"; }
    OptionTable describe() override;
    std::unique_ptr<Optics> make(double noise, int threads) const override;
    void explain(double noise, RunPlan& plan) const override;
};

/// The disc that stands for a sphere of diameter 1 in the frame.
Disc silhouette_of(Vec3 centre, const View& view);

}  // namespace grainfield::simulate
