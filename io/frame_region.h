#pragma once

#include <memory>
#include <optional>
#include <span>

#include "core/frame.h"
#include "core/frame_source.h"

namespace grainfield::io {

/// A rectangle of whole pixels.
struct FrameRegion {
    int x = 0, y = 0;  ///< its upper left pixel
    int width = 0, height = 0;
};

/// The region X, Y, WIDTH, HEIGHT in pixels of a source; no numbers: nothing. Throws OptionError if
/// they are not four or the rectangle does not lie within width × height pixels.
std::optional<FrameRegion> region_within(std::span<const int> sides, int width, int height);

/// That part of an image that holds all of it.
Image cropped(const Image& image, const FrameRegion& region);

/// That part of every frame; pixel (0, 0) of it is pixel (x, y) of the source.
std::unique_ptr<FrameSource> crop_frames(std::unique_ptr<FrameSource> source,
                                         const FrameRegion& region);

/// Every frame over the light field, times the mean of that: counts · ⟨F⟩/F. `flat` is a picture of
/// the empty, lit scene, of the size of the frames. Throws InputError if it is of another size or
/// has a pixel that is not positive.
std::unique_ptr<FrameSource> flatten_frames(std::unique_ptr<FrameSource> source, const Image& flat);

}  // namespace grainfield::io
