#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "core/frame_source.h"
#include "io/frame_file_options.h"
#include "io/images/picture.h"

namespace grainfield::io {

/// What reads and writes the files of one image format. Each format makes one in its own pair of
/// files; `image_formats` lists them all.
struct ImageFormat {
    std::string_view name;  ///< as in messages: "PNG"

    /// Whether a file is of this format, by its first bytes (`bytes_to_recognise` of them, or all).
    bool (*recognises)(std::string_view head);

    /// The one picture of a file. Throws CorruptPicture for a damaged or cut one, InputError above
    /// `max_pixels`. Thread-safe.
    Picture (*read)(const std::filesystem::path& path, std::int64_t max_pixels);

    /// Frames of a file that may hold several pictures; nullptr: it holds one.
    std::unique_ptr<FrameSource> (*open_pages)(const std::filesystem::path& path,
                                               const FrameFileOptions& options) = nullptr;

    std::string_view extension{};  ///< of files to write, without the dot; empty: it is only read

    /// Writes counts, row by row, words of 16 bit little-endian above 8 bit. Same counts, same
    /// bytes. Throws OutputError.
    void (*write)(const std::filesystem::path& path, std::span<const std::uint8_t> counts,
                  const PictureShape& shape) = nullptr;
};

constexpr std::size_t bytes_to_recognise = 16;

}  // namespace grainfield::io
