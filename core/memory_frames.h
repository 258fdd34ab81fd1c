#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_source.h"

namespace grainfield {

/// Frames in memory, all images of one size.
class MemoryFrames : public FrameSource {
 public:
    /// Frame i at the time i/`frame_rate` [s], or i if no rate is given. Throws InputError if there
    /// is no image, one is empty, or their sizes differ.
    explicit MemoryFrames(std::vector<Image> images, std::optional<double> frame_rate = {},
                          std::string name = "memory");
    /// The frames with their indices and times as they are, bad ones among them. Throws InputError
    /// if none has an image or the images differ in size.
    explicit MemoryFrames(std::vector<Frame> frames, std::optional<double> frame_rate = {},
                          std::string name = "memory");

    std::int64_t count() const override { return static_cast<std::int64_t>(frames_.size()); }
    int width() const override { return width_; }
    int height() const override { return height_; }
    int bit_depth() const override { return 16; }
    std::optional<double> frame_rate() const override { return frame_rate_; }
    Frame read(std::int64_t index) override;
    std::string name() const override { return name_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    std::vector<Frame> frames_;
    int width_ = 0;
    int height_ = 0;
    std::optional<double> frame_rate_;
    std::string name_;
    std::vector<std::string> warnings_;
};

}  // namespace grainfield
