#include "io/frame_files.h"

#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/images/image_sequence.h"
#include "io/input_file.h"
#include "io/images/tiff_frames.h"
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
                                         const FrameFileOptions& options) {
    require_valid(options);
    if (inputs.empty()) {
        throw InputError({.problem = "no input is given",
                          .actual = {},
                          .expected = "one video or a list of images",
                          .suggestion = "name the files, e.g. run7/*.tif"});
    }
    for (const auto& input : inputs) require_input_file(input);
    const auto& first = inputs.front();
    const ImageKind kind = identify_image(read_head(first, 16));
    if (inputs.size() == 1 && kind == ImageKind::tiff) return open_tiff(first, options);
    if (kind != ImageKind::none) return open_image_sequence(inputs, options);
    auto video = open_video(first, options);
    if (inputs.size() == 1) return video;
    throw InputError({.problem = fmt::format("'{}' cannot be part of a list", first.string()),
                      .actual = "it is a video",
                      .expected = "one video alone, or images",
                      .suggestion = "track the videos one by one"});
}

}  // namespace grainfield::io
