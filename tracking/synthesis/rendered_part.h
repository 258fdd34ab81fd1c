#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/frame_light.h"
#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

/// A rectangle of a frame as a calibrated model sees it.
struct FramePart {
    int x0 = 0, y0 = 0;  ///< of its first pixel in the frame
    Image brightness;    ///< 0 in the core of a sphere, 1 on the panel
    Image ceiling;       ///< the same of the brightest count

    /// Distance of a place in the frame from the border of the part [px]; negative: beyond it.
    double inside(Vec2 place) const;
};

/// Squares that a frame is sampled by: its middle, `side` wide at most [px]. A frame of 1.5 `side`
/// or more both ways has nine of half that width, in the middles of its ninths.
std::vector<FramePart> parts_of(const Image& counts, const ImageModel& model, double side);

/// The spheres of a part, how they are lit and seen.
struct RenderedPart {
    std::vector<Point3> spheres;  ///< [a] from the first pixel of the part; some lie beyond it
    MirrorOptics optics;
    FrameLight light;
    double rms = 0;  ///< of image − rendering [contrast]
};

/// What a rendering is made with.
struct RenderSetting {
    double diameter = 0;                       ///< a [px]
    double height = 0;                         ///< of the cell [a]
    double camera_distance = 0;                ///< [a]; 0: telecentric
    double frame_width = 0, frame_height = 0;  ///< the camera looks at the middle [px]
};

/// Heights, optics and light of a part, from the places of its discs [px of the frame]. Without
/// spheres in or beside it there are none in the result.
RenderedPart fitted_part(const FramePart& part, const ImageModel& model,
                         const std::vector<Vec2>& discs, const RenderSetting& setting, int threads);

/// Darkness of an image of those spheres with camera noise.
Image frame_of(const std::vector<Point3>& spheres, const RenderedPart& rendered,
               const FramePart& part, double diameter, double noise, std::uint64_t seed,
               std::uint64_t stream);

/// RMS of image − rendering where the spheres are at other places [contrast]. `places`: one a
/// sphere [px of the frame]; heights, optics and light stay.
double rms_at(const std::vector<Vec2>& places, const RenderedPart& rendered, const FramePart& part,
              double diameter, int threads);

}  // namespace grainfield::tracking
