#pragma once

#include <cstdint>
#include <string>

#include "core/frame.h"
#include "tracking/score/detection_scores.h"

namespace grainfield::bench {

enum class Matter { isolated, liquid, patch };
enum class CameraModel { own, silhouette };

/// A frame to be made with known truth. Lengths in diameters where not said otherwise.
struct FrameSpec {
    CameraModel camera = CameraModel::silhouette;  ///< own: the tracker's, at pixel centres
    Matter matter = Matter::liquid;
    double density = 0.72;  ///< liquid: area fraction; patch: projected lattice spacing
    double diameter = 16;   ///< [px]
    double noise = 0.02;    ///< halfway up an edge [contrast]
    double edge = 0.075;    ///< w of the tanh; silhouettes: a Gaussian blur of the same slope
    double path = 0;        ///< RMS way along an axis during the exposure; silhouettes only
    double side = 40;       ///< of the frame

    std::string scene() const;  ///< "isolated", "liquid 0.72", "patch 0.78"
    int pixels() const;         ///< along a side
};

/// A frame, the one before it (RMS step about 0.05 D per axis), and what is true of it: classes
/// "all" (centre at least D inside the frame) and "crystal" of those; bounds are not filled in.
struct KnownFrame {
    Image before, counts;
    tracking::TruthFrame truth;
};

/// Own frames: testing::tanh_frame. Silhouettes: simulate/render with its defaults (perspective,
/// falloff and vignetting, stray light, fixed pattern, defects), without dust; half the variance
/// halfway up an edge is shot noise, half is read noise.
KnownFrame make_frame(const FrameSpec& spec);

}  // namespace grainfield::bench
