#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/frame.h"
#include "core/frame_source.h"

namespace grainfield::io {

/// The colour filter before the pixels of a colour camera, by the first two pixels of the first two
/// rows.
enum class ColourFilter : std::uint8_t { none, rggb, grbg, gbrg, bggr };

/// What becomes of a mosaic of colours.
enum class MosaicChannel : std::uint8_t {
    grey,  ///< luma of the colours, for white light
    best,  ///< the colour of most contrast, for light of one colour
    red,
    green,
    blue
};

/// "RGGB"
const char* name_of(ColourFilter filter);
/// "red"
const char* name_of(MosaicChannel channel);

/// Contrast of the pixels of each colour, red, green, blue: their 98th less their second percentile
/// [counts].
std::array<double, 3> contrasts_of(const Image& mosaic, ColourFilter filter);

/// Frames of one value a pixel from the mosaic of a colour filter: absent colours are the mean of
/// their next neighbours (cv::cvtColor, bilinear), in counts of the file, rounded. Nothing moves;
/// noise of neighbouring pixels is correlated after it.
///
/// `channel`: not `best`, which the caller decides by contrasts_of. Throws InputError for frames of
/// less than 4 × 4 pixels or more than 16 bit.
std::unique_ptr<FrameSource> demosaic_frames(std::unique_ptr<FrameSource> source,
                                             ColourFilter filter, MosaicChannel channel);
Image demosaiced(const Image& mosaic, ColourFilter filter, MosaicChannel channel);

}  // namespace grainfield::io
