#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tiffio.h>

#include "io/colour_filter.h"
#include "io/images/picture.h"
#include "io/images/tiff_description.h"

namespace grainfield::io {

struct TiffMessages;
struct TiffLayout;

struct TiffDeleter {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

struct TiffPage {
    std::uint64_t offset = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint16_t bits = 1;
};

/// The pages of one TIFF or DNG, and the counts of each.
class TiffFile {
 public:
    /// Walks through the pages. Throws InputError, CorruptPicture if there is none.
    TiffFile(std::filesystem::path path, std::int64_t max_pixels);
    ~TiffFile();
    TiffFile(const TiffFile&) = delete;
    TiffFile& operator=(const TiffFile&) = delete;
    const std::filesystem::path& path() const { return path_; }
    const std::vector<TiffPage>& pages() const { return pages_; }
    const TiffDescription& description() const { return description_; }
    /// Of CinemaDNG [1/s].
    const std::optional<double>& frame_rate() const { return frame_rate_; }
    /// Why the list of pages broke off; empty if it came to its end.
    const std::string& cut_message() const { return cut_message_; }
    Picture read(std::size_t number);

 private:
    [[noreturn]] void fail(const std::string& fallback);
    void walk();
    // In DNG the counts of the sensor often stand below a page with a small picture of them.
    void note_raw_pages();
    /// A field that libtiff makes up has the type of the file.
    std::optional<double> read_frame_rate();
    void find_raw_pages();
    void note_description();
    TiffLayout read_layout();
    /// The numbers of a tag whose count is fixed in some releases of libtiff and passed in others.
    template <class Number>
    std::vector<Number> numbers_of(std::uint32_t tag);
    /// Without its table a file would give counts that are no measure of light.
    std::vector<std::uint16_t> read_table();
    ColourFilter read_filter();
    void require_supported(const TiffPage& page, const TiffLayout& layout) const;
    [[noreturn]] void refuse(
        std::string actual, std::string expected,
        std::string suggestion = "save it as 16-bit grey, not compressed") const;
    /// All samples as stored, plane after plane, row after row.
    std::vector<std::uint8_t> read_raw(const TiffPage& page, const TiffLayout& layout);
    void read_rows(const TiffPage& page, int plane, std::size_t row_bytes, std::uint8_t* out);
    void read_tiles(const TiffPage& page, int plane, std::size_t pixel_bits, std::uint8_t* out);
    /// Counts of 9 to 15 bit, the highest bits first; each row begins with a byte.
    static void unpack(const std::vector<std::uint8_t>& raw, const TiffPage& page,
                       const TiffLayout& layout, Image& image);
    template <class Sample>
    void convert(const std::vector<std::uint8_t>& raw, const TiffLayout& layout, Image& image);
    std::vector<float> read_palette();
    std::filesystem::path path_;
    std::int64_t max_pixels_;
    // On the heap: libtiff keeps its address.
    std::unique_ptr<TiffMessages> messages_;
    std::unique_ptr<TIFF, TiffDeleter> tiff_;
    std::vector<TiffPage> pages_;
    std::vector<std::uint64_t> raw_pages_;  ///< below other pages
    std::string cut_message_;
    TiffDescription description_;
    std::optional<double> frame_rate_;
};

}  // namespace grainfield::io
