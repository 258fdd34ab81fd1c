#pragma once

#include "io/images/image_format.h"

namespace grainfield::io {

/// Phantom recordings (Vision Research, .cine) that are not compressed: grey or raw Bayer of 8 to
/// 16 bit, packed 10 and 12 bit, colours of 8 or 16 bit a channel (taken as luma).
///
/// Layout, little-endian: "CI", length of the header, compression (0 grey or colours, 1 JPEG, 2 raw
/// of a colour filter); at 20 the number of images, at 24, 28 and 32 where the bitmap header, the
/// setup and the table of images begin. Bitmap header: width, height, bits of a pixel, packing (0
/// none, 0x100 10 bit, 0x400 12 bit; pixels follow one another, their highest bits first). Setup:
/// "ST" at 140, its length at 142, frame rate at 768, colour filter at 808, bits that count at 896.
/// Behind it blocks of length, type and data up to the table; type 1002 are times, 2^-32 s each.
/// The table holds an offset of 8 bytes an image. There stand the length of a note, the note, whose
/// last 4 bytes are the number of bytes of the pixels, and the pixels: the lowest row first unless
/// they are packed or the height is negative. Flips of the display are not applied.
///
/// Counts are those of the file. Packed 10 bit lie on a curve of the camera: a warning says so.
/// Frames are those that are there: a cut file keeps its whole ones and warns; an image whose
/// offset or length is wrong is a corrupt frame. Times are the stamps where they increase. JPEG and
/// unknown packing are refused with InputError.
ImageFormat cine_format();

}  // namespace grainfield::io
