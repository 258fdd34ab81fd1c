#pragma once

#include "tracking/calibrate/background.h"
#include "tracking/disc_profile.h"

namespace grainfield::tracking {

enum class Polarity { dark, bright };

/// How spheres and light make the image: I(x) = B(x) − [B(x) − I_dark] · (1 − Π_j (1 − P_j(x))),
/// with the roles of bright and dark exchanged for bright spheres. Estimated once, on the frame
/// that the calibration chose, and then frozen.
struct ImageModel {
    Polarity polarity = Polarity::dark;
    DiscProfile disc;
    BackgroundSurface background;  ///< B(x) [counts]
    double dark_level = 0;         ///< I_dark, counts in the core of a sphere
    double noise = 0;              ///< RMS of the residual away from edges [contrast]
    double residual_rms = 0;       ///< RMS of the residual over the frame [contrast]

    /// The darkness image: (B − I)/(B − I_dark), 0 on the background and 1 in the core of a sphere,
    /// clipped to [−0.5, 1.5].
    Image darkness(const Image& counts) const;
};

}  // namespace grainfield::tracking
