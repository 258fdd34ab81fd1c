#include "io/images/frame_writer.h"

#include <cstddef>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <png.h>
#include <tiffio.h>

#include "core/errors.h"
#include "io/video/frame_writer_video.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
    throw OutputError({.problem = fmt::format("cannot write '{}'", path.string()),
                       .actual = reason,
                       .expected = {},
                       .suggestion = "check the free space and quota of that disk"});
}

void save_tiff(const fs::path& path, const std::vector<std::uint8_t>& bytes,
               const FrameWriterOptions& o) {
    TIFF* tiff = TIFFOpen(path.c_str(), "w");
    if (tiff == nullptr) fail(path, "libtiff cannot open it");
    const int sample_bits = o.bit_depth > 8 ? 16 : 8;
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, o.width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, o.height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, sample_bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, o.height);
    auto* data = const_cast<std::uint8_t*>(bytes.data());  // libtiff does not write to it
    const bool whole = TIFFWriteEncodedStrip(tiff, 0, data, static_cast<tmsize_t>(bytes.size())) ==
                       static_cast<tmsize_t>(bytes.size());
    const bool flushed = TIFFFlush(tiff) == 1;
    TIFFClose(tiff);
    if (!whole || !flushed) fail(path, "not all of it could be written");
}

void save_png(const fs::path& path, const std::vector<std::uint8_t>& bytes,
              const FrameWriterOptions& o) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(o.width);
    header.height = static_cast<png_uint_32>(o.height);
    header.format = o.bit_depth > 8 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    header.flags = PNG_IMAGE_FLAG_FAST;
    if (png_image_write_to_file(&header, path.c_str(), 0, bytes.data(), 0, nullptr) == 0) {
        fail(path, header.message);
    }
}

class PictureFolder : public FrameWriter {
 public:
    PictureFolder(fs::path folder, const FrameWriterOptions& options, Overwrite overwrite)
        : folder_(std::move(folder)), options_(options), overwrite_(overwrite) {
        std::error_code error;
        if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
            throw OutputError({.problem = fmt::format("cannot write '{}'", folder_.string()),
                               .actual = "this is a file",
                               .expected = "a folder, or a name ending in .avi or .mkv",
                               .suggestion = {}});
        }
        fs::create_directories(folder_, error);
        if (error) fail(folder_, error.message());
        if (overwrite_ == Overwrite::refuse) refuse_old_frames();
    }

    void write(const Frame& frame) override {
        const std::vector<std::uint8_t> bytes = counts_of(frame, options_);
        const char* extension = options_.format == PictureFormat::png ? "png" : "tif";
        OutputFile file(folder_ / fmt::format("frame-{:06}.{}", frame.index, extension),
                        overwrite_);
        if (options_.format == PictureFormat::png) {
            save_png(file.temporary(), bytes, options_);
        } else {
            save_tiff(file.temporary(), bytes, options_);
        }
        file.commit();
    }

    void finish() override {}
    std::vector<fs::path> outputs() const override { return {folder_}; }

 private:
    // Frames of an older, longer series would join the new one unseen.
    void refuse_old_frames() const {
        for (const auto& entry : fs::directory_iterator(folder_)) {
            if (!entry.path().filename().string().starts_with("frame-")) continue;
            throw OutputError(
                {.problem = fmt::format("cannot write to '{}'", folder_.string()),
                 .actual = fmt::format("it holds '{}' already", entry.path().filename().string()),
                 .expected = {},
                 .suggestion = "give another name, or --force to replace frames"});
        }
    }

    fs::path folder_;
    FrameWriterOptions options_;
    Overwrite overwrite_;
};

}  // namespace

std::vector<std::uint8_t> counts_of(const Frame& frame, const FrameWriterOptions& options) {
    const Image& image = frame.image;
    if (image.width() != options.width || image.height() != options.height ||
        frame.bit_depth != options.bit_depth) {
        throw OptionError({.problem = fmt::format("frame {} does not fit its series", frame.index),
                           .actual = fmt::format("{} × {} pixels of {} bit", image.width(),
                                                 image.height(), frame.bit_depth),
                           .expected = fmt::format("{} × {} pixels of {} bit", options.width,
                                                   options.height, options.bit_depth),
                           .suggestion = {}});
    }
    std::vector<std::uint8_t> bytes;
    if (options.bit_depth <= 8) {
        bytes.resize(image.size());
        for (std::size_t i = 0; i < image.size(); ++i) {
            bytes[i] = static_cast<std::uint8_t>(image.pixels()[i]);
        }
        return bytes;
    }
    bytes.resize(2 * image.size());
    for (std::size_t i = 0; i < image.size(); ++i) {
        const auto count = static_cast<std::uint16_t>(image.pixels()[i]);
        bytes[2 * i] = static_cast<std::uint8_t>(count & 255U);
        bytes[2 * i + 1] = static_cast<std::uint8_t>(count >> 8U);
    }
    return bytes;
}

bool is_video_name(const fs::path& path) {
    return path.extension() == ".avi" || path.extension() == ".mkv";
}

std::unique_ptr<FrameWriter> make_frame_writer(const fs::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite) {
    if (is_video_name(path)) return make_video_writer(path, options, overwrite);
    return std::make_unique<PictureFolder>(path, options, overwrite);
}

}  // namespace grainfield::io
