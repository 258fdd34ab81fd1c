#pragma once

#include "io/images/image_format.h"

namespace grainfield::io {

/// JPEG through libavcodec: its luma plane.
ImageFormat jpeg_format();

/// BMP through libavcodec.
ImageFormat bmp_format();

/// PBM, PGM and PPM through libavcodec, with the counts of the file: exact up to 14 bit.
ImageFormat pnm_format();

}  // namespace grainfield::io
