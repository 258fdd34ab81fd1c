#include "io/images/tiff_format.h"

#include <algorithm>
#include <array>

#include <tiffio.h>

#include "io/images/tiff_frames.h"

namespace grainfield::io {

namespace {

using namespace std::string_view_literals;

bool is_tiff(std::string_view head) {
    constexpr std::array signatures{"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv};
    return std::ranges::any_of(signatures, [&](auto magic) { return head.starts_with(magic); });
}

void write_tiff(const std::filesystem::path& path, std::span<const std::uint8_t> counts,
                const PictureShape& shape) {
    TIFFSetErrorHandler(nullptr);  // what fails is thrown, not printed
    TIFFSetWarningHandler(nullptr);
    TIFF* tiff = TIFFOpen(path.c_str(), "w");
    if (tiff == nullptr) fail_to_write(path, "libtiff cannot open it");
    const int sample_bits = shape.bit_depth > 8 ? 16 : 8;
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, shape.width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, shape.height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, sample_bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, shape.height);
    auto* data = const_cast<std::uint8_t*>(counts.data());  // libtiff does not write to it
    const bool whole = TIFFWriteEncodedStrip(tiff, 0, data, static_cast<tmsize_t>(counts.size())) ==
                       static_cast<tmsize_t>(counts.size());
    const bool flushed = TIFFFlush(tiff) == 1;
    TIFFClose(tiff);
    if (!whole || !flushed) fail_to_write(path, "not all of it could be written");
}

}  // namespace

ImageFormat tiff_format() {
    return {.name = "TIFF",
            .recognises = is_tiff,
            .read = read_tiff,
            .open_pages = open_tiff,
            .extension = "tif",
            .write = write_tiff};
}

}  // namespace grainfield::io
