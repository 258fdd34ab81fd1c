#include "core/memory_frames.h"

#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

MemoryFrames::MemoryFrames(std::vector<Image> images, std::optional<double> frame_rate,
                           std::string name)
    : images_(std::move(images)), frame_rate_(frame_rate), name_(std::move(name)) {
    if (images_.empty()) throw InputError(ErrorText{name_ + " holds no image", "", "", ""});
    for (std::size_t i = 0; i < images_.size(); ++i) {
        const Image& image = images_[i];
        if (!image.empty() && image.width() == width() && image.height() == height()) continue;
        throw InputError(ErrorText{fmt::format("image {} of {} does not fit", i, name_),
                                   fmt::format("{} x {} px", image.width(), image.height()),
                                   fmt::format("{} x {} px, not empty", width(), height()), ""});
    }
}

Frame MemoryFrames::read(std::int64_t index) {
    if (index < 0 || index >= count()) {
        throw OptionError(ErrorText{fmt::format("{} has no such frame", name_),
                                    fmt::format("frame {}", index),
                                    fmt::format("0 to {}", count() - 1), ""});
    }
    Frame frame;
    frame.image = images_[static_cast<std::size_t>(index)];
    frame.index = index;
    frame.bit_depth = bit_depth();
    frame.time = static_cast<double>(index) / frame_rate_.value_or(1);
    return frame;
}

}  // namespace grainfield
