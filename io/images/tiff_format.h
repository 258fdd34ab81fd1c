#pragma once

#include "io/images/image_format.h"

namespace grainfield::io {

/// TIFF and BigTIFF, one page or many; written without compression in one strip.
ImageFormat tiff_format();

}  // namespace grainfield::io
