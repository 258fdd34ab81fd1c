#pragma once

#include <span>
#include <string>
#include <string_view>

#include "io/images/image_format.h"

namespace grainfield::io {

/// Every image format that the program knows: PNG, TIFF, JPEG, BMP, PNM.
std::span<const ImageFormat> image_formats();

/// The format of a file by its first bytes; nullptr if it is no image of `formats`.
const ImageFormat* find_image_format(std::string_view head, std::span<const ImageFormat> formats);

/// The format of that name; nullptr if there is none.
const ImageFormat* find_image_format_named(std::string_view name);

/// "PNG, TIFF or JPEG"
std::string names_of(std::span<const ImageFormat> formats);

}  // namespace grainfield::io
