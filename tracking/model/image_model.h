#pragma once

#include "core/frame.h"
#include "tracking/model/background_surface.h"
#include "tracking/model/binning.h"
#include "tracking/model/disc_model.h"

namespace grainfield::tracking {

enum class Polarity { dark, bright };

/// The light of one frame: what the calibration calls darkness d is seen there
/// as offset + span · d [contrast].
struct Illumination {
    double offset = 0;
    double span = 1;
};

/// How spheres and light make the image of a frame.
///
///   I(x) = B(x) − [B(x) − I_dark] · M(x),   M(x) = 1 − T(x)
///
/// T is the transmission of all discs (DiscModel): the product Π_j (1 − P_j(x)) of their profiles
/// (ProfileShape), what the rule for overlaps changes in it (OverlapRule), and what was learned of
/// the profile (RadialCorrection). B and I_dark [counts] are exchanged for bright spheres.
/// Calibration estimates it once, on one frame, and then it is frozen. Detection correlates with
/// P, refinement and the error bars use P and ∂P/∂r. "Add an image model" in CONTRIBUTING.md
/// names the files.
struct ImageModel : DiscModel {
    Polarity polarity = Polarity::dark;
    BackgroundSurface background;  ///< B(x) [counts]
    double dark_level = 0;         ///< I_dark, counts in the core of a sphere
    double noise = 0;              ///< RMS of the residual away from edges [contrast]
    double residual_rms = 0;       ///< RMS of the residual over the frame [contrast]
    Binning binning;               ///< frames are seen so; lengths above count its blocks

    /// The same model of the pixels themselves; noise is that of independent ones.
    ImageModel in_pixels() const;

    /// The darkness image: (B − I)/(B − I_dark), 0 on the background and 1 in the
    /// core of a sphere, corrected for the light of the frame, clipped to
    /// [−0.5, 1.5].
    Image darkness(const Image& counts, const Illumination& light = {}) const;
    /// Row y of it.
    void darkness_row(const Image& counts, const Illumination& light, int y, float* out) const;

    /// The same of one pixel, as calibrated, not clipped.
    struct PixelDarkness {
        float background, per_count;
        float operator()(float count) const { return (background - count) * per_count; }
    };
    PixelDarkness darkness_of(int x, int y) const;
};

}  // namespace grainfield::tracking
