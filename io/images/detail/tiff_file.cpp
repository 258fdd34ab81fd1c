#include "io/images/detail/tiff_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/input_file.h"

#if TIFFLIB_VERSION < 20221213
#error "libtiff 4.5 or newer is needed: its messages are collected per file"
#endif

namespace grainfield::io {

struct TiffMessages {
    std::string first;
    std::string of_table;  ///< what is said of a table that libtiff does not take

    static std::string text_of(const char* module, const char* format, va_list arguments) {
        std::array<char, 400> text{};
        std::vsnprintf(text.data(), text.size(), format, arguments);
        return fmt::format("{}: {}", module == nullptr ? "libtiff" : module, text.data());
    }
    void add(const std::string& text) {
        if (first.empty()) first = text;
    }
    std::string take() { return std::exchange(first, {}); }
};

/// The layout of a page as its tags say.
struct TiffLayout {
    std::uint16_t samples = 1;
    std::uint16_t planar = PLANARCONFIG_CONTIG;
    std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    std::uint16_t format = SAMPLEFORMAT_UINT;
    std::uint16_t compression = COMPRESSION_NONE;
    ColourFilter filter = ColourFilter::none;
    bool is_of_sensor = false;         ///< of DNG
    std::vector<std::uint16_t> table;  ///< of DNG: counts in proportion to light, by stored value

    /// Values beyond the end of the table take its last entry.
    std::int32_t linear(std::uint32_t stored) const {
        if (table.empty()) return static_cast<std::int32_t>(stored);
        return table[std::min<std::size_t>(stored, table.size() - 1)];
    }
    /// Of the counts that come out.
    int bit_depth(std::uint16_t stored_bits) const {
        if (table.empty()) return stored_bits;
        return std::max(8, static_cast<int>(std::bit_width(*std::ranges::max_element(table))));
    }
    int planes() const { return planar == PLANARCONFIG_SEPARATE ? samples : 1; }
    int samples_in_plane() const { return planar == PLANARCONFIG_SEPARATE ? 1 : samples; }
};

namespace {

int on_error(TIFF*, void* user, const char* module, const char* format, va_list arguments) {
    static_cast<TiffMessages*>(user)->add(TiffMessages::text_of(module, format, arguments));
    return 1;
}

// Unknown tags and the like are harmless, but a cut JPEG strip is only warned about, and so
// is a table that is left out.
int on_warning(TIFF*, void* user, const char* module, const char* format, va_list arguments) {
    auto& messages = *static_cast<TiffMessages*>(user);
    const std::string text = TiffMessages::text_of(module, format, arguments);
    if (module != nullptr && std::string_view(module).starts_with("JPEG")) messages.add(text);
    if (text.find("LinearizationTable") != std::string::npos) messages.of_table = text;
    return 1;
}

constexpr std::uint16_t photometric_linear_raw = 34892;  // of DNG: counts of the sensor
constexpr std::uint32_t frame_rate_tag = 51044;          // of CinemaDNG; libtiff does not know it

}  // namespace

TiffFile::TiffFile(std::filesystem::path path, std::int64_t max_pixels)
    : path_(std::move(path)), max_pixels_(max_pixels), messages_(std::make_unique<TiffMessages>()) {
    require_input_file(path_);
    const std::unique_ptr<TIFFOpenOptions, TiffDeleter> options(TIFFOpenOptionsAlloc());
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), on_error, messages_.get());
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), on_warning, messages_.get());
    const std::int64_t largest = std::max<std::int64_t>(max_pixels_, 1 << 24) * 8;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), largest);
    // Not memory-mapped ("m"): a file that shrinks while it is read must not end the program.
    tiff_.reset(TIFFOpenExt(path_.c_str(), "rm", options.get()));
    if (!tiff_) throw CorruptPicture(path_, messages_->take());
    walk();
    if (pages_.empty()) {
        throw CorruptPicture(path_, cut_message_.empty() ? "no page" : cut_message_);
    }
}

TiffFile::~TiffFile() = default;

Picture TiffFile::read(std::size_t number) {
    const TiffPage& page = pages_[number];
    messages_->take();
    messages_->of_table.clear();
    if (TIFFSetSubDirectory(tiff_.get(), page.offset) == 0) fail("no such page");
    require_pixel_count(path_, page.width, page.height, max_pixels_);
    const TiffLayout layout = read_layout();
    require_supported(page, layout);
    const std::vector<std::uint8_t> raw = read_raw(page, layout);
    Picture picture{Image(static_cast<int>(page.width), static_cast<int>(page.height)),
                    layout.bit_depth(page.bits), layout.filter, frame_rate_};
    if (page.bits == 8) {
        convert<std::uint8_t>(raw, layout, picture.image);
    } else if (page.bits == 16) {
        convert<std::uint16_t>(raw, layout, picture.image);
    } else {
        unpack(raw, page, layout, picture.image);
    }
    return picture;
}

void TiffFile::fail(const std::string& fallback) {
    const std::string message = messages_->take();
    throw CorruptPicture(path_, message.empty() ? fallback : message);
}

void TiffFile::walk() {
    do {
        TiffPage page;
        page.offset = TIFFCurrentDirOffset(tiff_.get());
        std::uint32_t kind = 0;
        TIFFGetField(tiff_.get(), TIFFTAG_SUBFILETYPE, &kind);
        note_raw_pages();
        if ((kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0) continue;
        TIFFGetField(tiff_.get(), TIFFTAG_IMAGEWIDTH, &page.width);
        TIFFGetField(tiff_.get(), TIFFTAG_IMAGELENGTH, &page.height);
        TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_BITSPERSAMPLE, &page.bits);
        pages_.push_back(page);
        note_description();
        messages_->take();
    } while (TIFFReadDirectory(tiff_.get()) != 0);
    if (std::string message = messages_->take(); !message.empty()) cut_message_ = message;
    if (!raw_pages_.empty()) find_raw_pages();
    if (const std::uint64_t promised = description_.pages.value_or(0);
        cut_message_.empty() && promised > pages_.size()) {
        cut_message_ = fmt::format("{} pages promised by its description", promised);
    }
}

void TiffFile::note_raw_pages() {
    if (numbers_of<std::uint8_t>(TIFFTAG_DNGVERSION).empty()) return;
    if (!frame_rate_) frame_rate_ = read_frame_rate();
    std::uint16_t count = 0;
    const std::uint64_t* offsets = nullptr;
    if (TIFFGetField(tiff_.get(), TIFFTAG_SUBIFD, &count, &offsets) == 0) return;
    raw_pages_.insert(raw_pages_.end(), offsets, offsets + count);
}

std::optional<double> TiffFile::read_frame_rate() {
    const TIFFField* field = TIFFFindField(tiff_.get(), frame_rate_tag, TIFF_ANY);
    if (field == nullptr || TIFFFieldPassCount(field) == 0) return std::nullopt;
    // As a number: a damaged file has types that no TIFFDataType can hold.
    const auto type = static_cast<unsigned>(TIFFFieldDataType(field));
    if (type != TIFF_SRATIONAL && type != TIFF_RATIONAL) return std::nullopt;
    if (TIFFFieldSetGetSize(field) != sizeof(float)) return std::nullopt;
    const std::vector<float> rate = numbers_of<float>(frame_rate_tag);
    constexpr float most = 1e9F;  // such as a camera can have
    if (rate.size() != 1 || !(rate[0] >= 1 / most && rate[0] <= most)) return std::nullopt;
    return static_cast<double>(rate[0]);
}

void TiffFile::find_raw_pages() {
    std::vector<TiffPage> found;
    for (const std::uint64_t offset : raw_pages_) {
        TiffPage page;
        page.offset = offset;
        if (TIFFSetSubDirectory(tiff_.get(), offset) == 0) continue;
        std::uint32_t kind = 0;
        std::uint16_t photometric = 0;
        TIFFGetField(tiff_.get(), TIFFTAG_SUBFILETYPE, &kind);
        TIFFGetField(tiff_.get(), TIFFTAG_PHOTOMETRIC, &photometric);
        if (kind != 0) continue;
        if (photometric != PHOTOMETRIC_CFA && photometric != photometric_linear_raw) continue;
        TIFFGetField(tiff_.get(), TIFFTAG_IMAGEWIDTH, &page.width);
        TIFFGetField(tiff_.get(), TIFFTAG_IMAGELENGTH, &page.height);
        TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_BITSPERSAMPLE, &page.bits);
        found.push_back(page);
    }
    if (std::string message = messages_->take(); cut_message_.empty()) cut_message_ = message;
    if (!found.empty()) pages_ = std::move(found);
}

void TiffFile::note_description() {
    const char* description = nullptr;
    if (pages_.size() != 1) return;
    if (TIFFGetField(tiff_.get(), TIFFTAG_IMAGEDESCRIPTION, &description) == 0) return;
    description_ = tiff_description(description);
}

TiffLayout TiffFile::read_layout() {
    TiffLayout layout;
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SAMPLESPERPIXEL, &layout.samples);
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_PLANARCONFIG, &layout.planar);
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SAMPLEFORMAT, &layout.format);
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_COMPRESSION, &layout.compression);
    if (TIFFGetField(tiff_.get(), TIFFTAG_PHOTOMETRIC, &layout.photometric) == 0) {
        layout.photometric = layout.samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
    }
    if (layout.compression == COMPRESSION_JPEG && layout.photometric == PHOTOMETRIC_YCBCR) {
        TIFFSetField(tiff_.get(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
        layout.photometric = PHOTOMETRIC_RGB;
    }
    if (layout.photometric == photometric_linear_raw || layout.photometric == PHOTOMETRIC_CFA) {
        layout.is_of_sensor = true;
        layout.table = read_table();
    }
    if (layout.photometric == photometric_linear_raw) {
        layout.photometric = layout.samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
    }
    if (layout.photometric == PHOTOMETRIC_CFA) {
        layout.filter = read_filter();
        layout.photometric = PHOTOMETRIC_MINISBLACK;
    }
    return layout;
}

template <class Number>
std::vector<Number> TiffFile::numbers_of(std::uint32_t tag) {
    const TIFFField* field = TIFFFindField(tiff_.get(), tag, TIFF_ANY);
    const Number* numbers = nullptr;
    if (field == nullptr) return {};
    const int fixed = TIFFFieldReadCount(field);
    if (TIFFFieldPassCount(field) == 0) {
        if (fixed < 1 || TIFFGetField(tiff_.get(), tag, &numbers) == 0) return {};
        return {numbers, numbers + fixed};
    }
    std::uint16_t count = 0;
    std::uint32_t long_count = 0;
    if (fixed == TIFF_VARIABLE2) {
        if (TIFFGetField(tiff_.get(), tag, &long_count, &numbers) == 0) return {};
    } else {
        if (TIFFGetField(tiff_.get(), tag, &count, &numbers) == 0) return {};
        long_count = count;
    }
    return {numbers, numbers + long_count};
}

std::vector<std::uint16_t> TiffFile::read_table() {
    if (!messages_->of_table.empty()) {
        refuse(fmt::format("its counts go through a table that cannot be read ({})",
                           messages_->of_table),
               "a LinearizationTable of at most 65,535 values, or none");
    }
    return numbers_of<std::uint16_t>(TIFFTAG_LINEARIZATIONTABLE);
}

ColourFilter TiffFile::read_filter() {
    const auto sides = numbers_of<std::uint16_t>(TIFFTAG_CFAREPEATPATTERNDIM);
    const auto colours = numbers_of<std::uint8_t>(TIFFTAG_CFAPATTERN);
    using Pattern = std::vector<std::uint8_t>;
    if (sides == std::vector<std::uint16_t>{2, 2}) {
        if (colours == Pattern{0, 1, 1, 2}) return ColourFilter::rggb;
        if (colours == Pattern{1, 0, 2, 1}) return ColourFilter::grbg;
        if (colours == Pattern{1, 2, 0, 1}) return ColourFilter::gbrg;
        if (colours == Pattern{2, 1, 1, 0}) return ColourFilter::bggr;
    }
    refuse(fmt::format("a colour filter of {} x {} pixels", sides.empty() ? 0 : sides[0],
                       sides.size() < 2 ? 0 : sides[1]),
           "two rows and columns of red, green, green, blue");
}

void TiffFile::require_supported(const TiffPage& page, const TiffLayout& layout) const {
    const bool grey = layout.photometric == PHOTOMETRIC_MINISBLACK ||
                      layout.photometric == PHOTOMETRIC_MINISWHITE;
    const bool colour = layout.photometric == PHOTOMETRIC_RGB && layout.samples >= 3;
    const bool palette = layout.photometric == PHOTOMETRIC_PALETTE && page.bits == 8;
    const bool is_packed = page.bits > 8 && page.bits < 16 && layout.samples == 1;
    const bool depth = page.bits == 8 || page.bits == 16 || (is_packed && grey);
    const bool is_known = TIFFIsCODECConfigured(layout.compression) != 0;
    // libtiff reads JPEG as pictures have it, not the lossless one of DNG.
    if (layout.is_of_sensor && (layout.compression == COMPRESSION_JPEG || !is_known)) {
        refuse(layout.compression == COMPRESSION_JPEG
                   ? std::string("counts of the sensor in JPEG (compression 7)")
                   : fmt::format("counts of the sensor in compression {}", layout.compression),
               "a DNG that is not compressed",
               "make 16-bit TIFF of it, the counts as they are, with 'dcraw -D -4 -T FILE', or "
               "save it uncompressed with Adobe's DNG Converter");
    }
    if (depth && layout.format == SAMPLEFORMAT_UINT && layout.samples >= 1 &&
        layout.samples <= 16 && (grey || colour || palette)) {
        return;
    }
    if (!is_known) {
        refuse(fmt::format("compression {}", layout.compression), "a compression of libtiff");
    }
    refuse(fmt::format("{} bit, {} samples per pixel, sample format {}, photometric {}", page.bits,
                       layout.samples, layout.format, layout.photometric),
           "8 to 16 bit unsigned grey, or RGB or palette of 8 or 16 bit");
}

void TiffFile::refuse(std::string actual, std::string expected, std::string suggestion) const {
    throw InputError({.problem = fmt::format("cannot use the TIFF '{}'", path_.string()),
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = std::move(suggestion)});
}

std::vector<std::uint8_t> TiffFile::read_raw(const TiffPage& page, const TiffLayout& layout) {
    const std::size_t pixel_bits = static_cast<std::size_t>(layout.samples_in_plane()) * page.bits;
    const std::size_t row_bytes = (pixel_bits * page.width + 7) / 8;
    std::vector<std::uint8_t> raw(row_bytes * page.height *
                                  static_cast<std::size_t>(layout.planes()));
    for (int plane = 0; plane < layout.planes(); ++plane) {
        std::uint8_t* start =
            raw.data() + row_bytes * page.height * static_cast<std::size_t>(plane);
        if (TIFFIsTiled(tiff_.get()) != 0) {
            read_tiles(page, plane, pixel_bits, start);
        } else {
            read_rows(page, plane, row_bytes, start);
        }
    }
    // libtiff repairs some damage and continues.
    if (!messages_->first.empty()) fail({});
    return raw;
}

void TiffFile::read_rows(const TiffPage& page, int plane, std::size_t row_bytes,
                         std::uint8_t* out) {
    const tmsize_t line = TIFFScanlineSize(tiff_.get());
    if (line < static_cast<tmsize_t>(row_bytes)) fail("rows are shorter than the width");
    std::vector<std::uint8_t> buffer(static_cast<std::size_t>(line));
    for (std::uint32_t y = 0; y < page.height; ++y) {
        if (TIFFReadScanline(tiff_.get(), buffer.data(), y, static_cast<std::uint16_t>(plane)) !=
            1) {
            fail(fmt::format("row {} cannot be decoded", y));
        }
        std::memcpy(out + y * row_bytes, buffer.data(), row_bytes);
    }
}

void TiffFile::read_tiles(const TiffPage& page, int plane, std::size_t pixel_bits,
                          std::uint8_t* out) {
    std::uint32_t tile_width = 0;
    std::uint32_t tile_height = 0;
    TIFFGetField(tiff_.get(), TIFFTAG_TILEWIDTH, &tile_width);
    TIFFGetField(tiff_.get(), TIFFTAG_TILELENGTH, &tile_height);
    require_pixel_count(path_, tile_width, tile_height, max_pixels_);
    if (pixel_bits * tile_width % 8 != 0) fail("tiles end within a byte");
    const std::size_t row_bytes = (pixel_bits * page.width + 7) / 8;
    const std::size_t tile_row = pixel_bits * tile_width / 8;
    const tmsize_t bytes = TIFFTileSize(tiff_.get());
    if (bytes < static_cast<tmsize_t>(tile_row * tile_height)) fail("tiles are too short");
    std::vector<std::uint8_t> tile(static_cast<std::size_t>(bytes));
    for (std::uint32_t y = 0; y < page.height; y += tile_height) {
        for (std::uint32_t x = 0; x < page.width; x += tile_width) {
            if (TIFFReadTile(tiff_.get(), tile.data(), x, y, 0, static_cast<std::uint16_t>(plane)) <
                0) {
                fail(fmt::format("the tile at ({}, {}) cannot be decoded", x, y));
            }
            const std::size_t first = x * pixel_bits / 8;
            const std::size_t columns = std::min(tile_row, row_bytes - first);
            const std::uint32_t rows = std::min(tile_height, page.height - y);
            for (std::uint32_t row = 0; row < rows; ++row) {
                std::memcpy(out + (std::size_t{y} + row) * row_bytes + first,
                            tile.data() + row * tile_row, columns);
            }
        }
    }
}

void TiffFile::unpack(const std::vector<std::uint8_t>& raw, const TiffPage& page,
                      const TiffLayout& layout, Image& image) {
    const std::uint32_t white = (1U << page.bits) - 1U;
    const std::size_t row_bytes = (std::size_t{page.width} * page.bits + 7) / 8;
    for (std::uint32_t y = 0; y < page.height; ++y) {
        const std::uint8_t* in = raw.data() + y * row_bytes;
        float* out = image.pixels().data() + std::size_t{y} * page.width;
        std::uint32_t held = 0;
        unsigned bits = 0;
        for (std::uint32_t x = 0; x < page.width; ++x) {
            for (; bits < page.bits; bits += 8) held = held << 8U | *in++;
            bits -= page.bits;
            const std::uint32_t count = held >> bits & white;
            out[x] = layout.photometric == PHOTOMETRIC_MINISWHITE
                         ? static_cast<float>(white - count)
                         : static_cast<float>(layout.linear(count));
        }
    }
}

template <class Sample>
void TiffFile::convert(const std::vector<std::uint8_t>& raw, const TiffLayout& layout,
                       Image& image) {
    const std::size_t pixels = image.size();
    const bool separate = layout.planes() > 1;
    const auto sample = [&](std::size_t pixel, std::size_t channel) {
        const std::size_t at =
            separate ? channel * pixels + pixel : pixel * layout.samples + channel;
        Sample value;
        std::memcpy(&value, raw.data() + at * sizeof(Sample), sizeof(Sample));
        return layout.linear(value);
    };
    float* out = image.pixels().data();
    if (layout.photometric == PHOTOMETRIC_PALETTE) {
        const std::vector<float> palette = read_palette();
        for (std::size_t i = 0; i < pixels; ++i) {
            out[i] = palette[static_cast<std::size_t>(sample(i, 0)) & 255U];
        }
    } else if (layout.photometric == PHOTOMETRIC_RGB) {
        for (std::size_t i = 0; i < pixels; ++i) {
            out[i] = luma(sample(i, 0), sample(i, 1), sample(i, 2));
        }
    } else if (layout.photometric == PHOTOMETRIC_MINISWHITE) {
        constexpr std::int32_t white = std::numeric_limits<Sample>::max();
        for (std::size_t i = 0; i < pixels; ++i) {
            out[i] = static_cast<float>(white - sample(i, 0));
        }
    } else {
        for (std::size_t i = 0; i < pixels; ++i) out[i] = static_cast<float>(sample(i, 0));
    }
}

std::vector<float> TiffFile::read_palette() {
    std::uint16_t* red = nullptr;
    std::uint16_t* green = nullptr;
    std::uint16_t* blue = nullptr;
    if (TIFFGetField(tiff_.get(), TIFFTAG_COLORMAP, &red, &green, &blue) == 0) {
        fail("the palette is absent");
    }
    std::vector<float> palette(256);
    for (std::size_t i = 0; i < palette.size(); ++i) {
        palette[i] = luma(red[i] >> 8, green[i] >> 8, blue[i] >> 8);
    }
    return palette;
}

}  // namespace grainfield::io
