#include "io/frame_files.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/file_kind.h"
#include "io/images/file_numbering.h"
#include "io/images/image_sequence.h"
#include "io/images/photron_raw.h"
#include "io/images/picture.h"
#include "io/images/picture_folder.h"
#include "io/input_file.h"
#include "io/joined_films.h"
#include "io/video/lossless_video.h"
#include "io/video/video_frames.h"

namespace grainfield::io {

namespace {

void require_valid(const FrameFileOptions& options) {
    if (options.fps && !(std::isfinite(*options.fps) && *options.fps > 0)) {
        throw OptionError({.problem = "option 'fps' has a wrong value",
                           .actual = fmt::format("{}", *options.fps),
                           .expected = "a finite positive number [1/s]",
                           .suggestion = {}});
    }
    if (options.max_pixels < 1) {
        throw OptionError({.problem = "option 'max-pixels' has a wrong value",
                           .actual = fmt::format("{}", options.max_pixels),
                           .expected = "at least 1 [px]",
                           .suggestion = {}});
    }
}

const ImageFormat* format_of(const std::filesystem::path& path,
                             std::span<const ImageFormat> formats) {
    // Raw counts may look like anything.
    if (is_photron_name(path)) return nullptr;
    return find_image_format(read_head(path, bytes_to_recognise), formats);
}

/// All frames of one file.
std::unique_ptr<FrameSource> open_part(const std::filesystem::path& path,
                                       const FrameFileOptions& options,
                                       std::span<const ImageFormat> formats) {
    if (is_photron_name(path)) return open_photron(path, options);
    const ImageFormat* format = format_of(path, formats);
    if (format == nullptr) return open_video(path, options);
    if (format->open_pages != nullptr) return format->open_pages(path, options);
    return open_image_sequence({path}, options, formats);
}

/// More than one; a damaged picture is one of a list.
bool holds_pages(const std::filesystem::path& path, const ImageFormat& format,
                 const FrameFileOptions& options) {
    if (format.open_pages == nullptr) return false;
    try {
        return format.open_pages(path, options)->count() > 1;
    } catch (const CorruptPicture&) {
        return false;
    }
}

void require_same_kind(const std::filesystem::path& path, const std::filesystem::path& first,
                       const ImageFormat* kind, std::span<const ImageFormat> formats) {
    const ImageFormat* found = format_of(path, formats);
    if (found == kind) return;
    const auto name = [](const ImageFormat* format) {
        return format == nullptr ? std::string("a video") : std::string(format->name);
    };
    throw InputError({.problem = fmt::format("'{}' is not a part of the film that begins with '{}'",
                                             path.string(), first.string()),
                      .actual = name(found),
                      .expected = fmt::format("{}, as the first", name(kind)),
                      .suggestion = "give the files of one film"});
}

/// Positions and results are no film, and libraries for videos would only say that data are wrong.
void require_pictures(const std::filesystem::path& path, std::span<const ImageFormat> formats) {
    if (format_of(path, formats) != nullptr) return;
    const auto refuse = [&](const char* what, const char* suggestion) {
        throw InputError({.problem = fmt::format("'{}' is not a film", path.string()),
                          .actual = what,
                          .expected = "a video or images",
                          .suggestion = suggestion});
    };
    switch (identify(path)) {
        case FileKind::trajectory:
            refuse("positions", "analyze them, or render frames of a simulation first");
            break;
        case FileKind::points:
            refuse("a list of points", "analyze them");
            break;
        case FileKind::field:
            refuse("fields", "analyze them");
            break;
        case FileKind::results:
            refuse("results of an analysis", "compare them");
            break;
        case FileKind::unknown:
            break;
    }
}

}  // namespace

std::unique_ptr<FrameSource> open_frames(const std::vector<std::filesystem::path>& given,
                                         const FrameFileOptions& options,
                                         std::span<const ImageFormat> formats) {
    require_valid(options);
    if (given.empty()) {
        throw InputError({.problem = "no input is given",
                          .actual = {},
                          .expected = "one video or a list of images",
                          .suggestion = "name the files, e.g. run7/*.tif"});
    }
    for (const auto& input : given) {
        require_input_file(input);
        require_pictures(input, formats);
    }
    const std::vector<std::filesystem::path> inputs = each_photron_once(given);
    // The first part of a recording is a full one; the last may hold a single page.
    const auto& first = *std::ranges::min_element(
        inputs, [](const auto& a, const auto& b) { return natural_less(a.native(), b.native()); });
    const ImageFormat* format = format_of(first, formats);
    if (inputs.size() == 1) return open_part(first, options, formats);
    require_same_kind(inputs.front(), first, format, formats);
    if (format != nullptr && !holds_pages(first, *format, options)) {
        return open_image_sequence(inputs, options, formats);
    }
    for (const auto& input : inputs) require_same_kind(input, first, format, formats);
    return join_parts(
        inputs,
        [options, formats](const std::filesystem::path& path) {
            return open_part(path, options, formats);
        },
        options.fps);
}

bool is_video_name(const std::filesystem::path& path) {
    return path.extension() == ".avi" || path.extension() == ".mkv";
}

std::unique_ptr<FrameWriter> make_frame_writer(const std::filesystem::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite) {
    if (is_video_name(path)) return make_video_writer(path, options, overwrite);
    return make_picture_folder(path, options, overwrite);
}

}  // namespace grainfield::io
