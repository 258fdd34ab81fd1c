#include "core/memory_frames.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

std::vector<Frame> film_of(std::vector<Image> images, double frame_rate, const std::string& name) {
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (images[i].empty()) {
            throw InputError(
                ErrorText{fmt::format("image {} of {} is empty", i, name), "", "", ""});
        }
        Frame& frame = frames.emplace_back();
        frame.image = std::move(images[i]);
        frame.index = static_cast<std::int64_t>(i);
        frame.time = static_cast<double>(i) / frame_rate;
    }
    return frames;
}

}  // namespace

MemoryFrames::MemoryFrames(std::vector<Image> images, std::optional<double> frame_rate,
                           std::string name)
    : MemoryFrames(film_of(std::move(images), frame_rate.value_or(1), name), frame_rate, name) {}

MemoryFrames::MemoryFrames(std::vector<Frame> frames, std::optional<double> frame_rate,
                           std::string name)
    : frames_(std::move(frames)), frame_rate_(frame_rate), name_(std::move(name)) {
    const auto first =
        std::ranges::find_if(frames_, [](const Frame& frame) { return !frame.image.empty(); });
    if (first == frames_.end()) {
        throw InputError(ErrorText{name_ + " holds no image", "", "", ""});
    }
    width_ = first->image.width();
    height_ = first->image.height();
    for (Frame& frame : frames_) {
        frame.bit_depth = bit_depth();
        const Image& image = frame.image;
        if (image.empty() || (image.width() == width_ && image.height() == height_)) continue;
        throw InputError(ErrorText{fmt::format("image {} of {} does not fit", frame.index, name_),
                                   fmt::format("{} x {} px", image.width(), image.height()),
                                   fmt::format("{} x {} px", width_, height_), ""});
    }
}

Frame MemoryFrames::read(std::int64_t index) {
    if (index < 0 || index >= count()) {
        throw OptionError(ErrorText{fmt::format("{} has no such frame", name_),
                                    fmt::format("frame {}", index),
                                    fmt::format("0 to {}", count() - 1), ""});
    }
    return frames_[static_cast<std::size_t>(index)];
}

}  // namespace grainfield
