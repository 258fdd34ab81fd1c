#include "io/frame_files.h"

#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/images/image_sequence.h"
#include "io/images/picture_folder.h"
#include "io/input_file.h"
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

}  // namespace

std::unique_ptr<FrameSource> open_frames(const std::vector<std::filesystem::path>& inputs,
                                         const FrameFileOptions& options,
                                         std::span<const ImageFormat> formats) {
    require_valid(options);
    if (inputs.empty()) {
        throw InputError({.problem = "no input is given",
                          .actual = {},
                          .expected = "one video or a list of images",
                          .suggestion = "name the files, e.g. run7/*.tif"});
    }
    for (const auto& input : inputs) require_input_file(input);
    const auto& first = inputs.front();
    if (const ImageFormat* format =
            find_image_format(read_head(first, bytes_to_recognise), formats)) {
        if (inputs.size() == 1 && format->open_pages != nullptr) {
            return format->open_pages(first, options);
        }
        return open_image_sequence(inputs, options, formats);
    }
    auto video = open_video(first, options);
    if (inputs.size() == 1) return video;
    throw InputError({.problem = fmt::format("'{}' cannot be part of a list", first.string()),
                      .actual = "it is a video",
                      .expected = "one video alone, or images",
                      .suggestion = "track the videos one by one"});
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
