#pragma once

#include "io/images/image_format.h"

namespace grainfield::io {

/// Norpix sequences (StreamPix, .seq): uncompressed grey or Bayer frames of 8 to 16 bit, each with
/// its time stamp.
///
/// Layout, little-endian: 0xFEED and "Norpix seq" in UTF-16; from byte 28 version and length of the
/// header, from 548 width, height, bits as stored, bits that count, bytes and format of an image
/// (100 grey, 101 raw Bayer); at 580 the distance from image to image, at 584 the frame rate,
/// at 620 the compression (0: none). Images begin at byte 1024, from version 5 on at 8192. Behind
/// each image stand seconds (4 bytes) and milliseconds (2 bytes) of its time, from version 5 on
/// microseconds as well (2 bytes).
///
/// Frames are those that are there: a cut file keeps its whole ones and warns. Times are the stamps
/// where they increase. Other formats of images, compressed ones, and files whose numbers
/// contradict one another, are refused with InputError.
ImageFormat norpix_format();

}  // namespace grainfield::io
