#include "io/images/image_formats.h"

#include <algorithm>
#include <array>

#include "io/images/coded_image.h"
#include "io/images/norpix_seq.h"
#include "io/images/phantom_cine.h"
#include "io/images/png_image.h"
#include "io/images/tiff_format.h"

namespace grainfield::io {

std::span<const ImageFormat> image_formats() {
    static const std::array formats{
        png_format(), tiff_format(),   jpeg_format(), bmp_format(),
        pnm_format(), norpix_format(), cine_format(),
    };
    return formats;
}

const ImageFormat* find_image_format(std::string_view head, std::span<const ImageFormat> formats) {
    const auto found = std::ranges::find_if(
        formats, [&](const ImageFormat& format) { return format.recognises(head); });
    return found == formats.end() ? nullptr : &*found;
}

const ImageFormat* find_image_format_named(std::string_view name) {
    const auto found = std::ranges::find(image_formats(), name, &ImageFormat::name);
    return found == image_formats().end() ? nullptr : &*found;
}

std::string names_of(std::span<const ImageFormat> formats) {
    std::string names;
    for (std::size_t i = 0; i < formats.size(); ++i) {
        if (i > 0) names += i + 1 == formats.size() ? " or " : ", ";
        names += formats[i].name;
    }
    return names;
}

}  // namespace grainfield::io
