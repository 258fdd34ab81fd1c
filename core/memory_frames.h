#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_source.h"

namespace grainfield {

/// Frames from images in memory, all of one size.
class MemoryFrames : public FrameSource {
 public:
    /// Frame i at the time i/`frame_rate` [s], or i if no rate is given. Throws InputError if there
    /// is no image, one is empty, or their sizes differ.
    explicit MemoryFrames(std::vector<Image> images, std::optional<double> frame_rate = {},
                          std::string name = "memory");

    std::int64_t count() const override { return static_cast<std::int64_t>(images_.size()); }
    int width() const override { return images_[0].width(); }
    int height() const override { return images_[0].height(); }
    int bit_depth() const override { return 16; }
    std::optional<double> frame_rate() const override { return frame_rate_; }
    Frame read(std::int64_t index) override;
    std::string name() const override { return name_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    std::vector<Image> images_;
    std::optional<double> frame_rate_;
    std::string name_;
    std::vector<std::string> warnings_;
};

}  // namespace grainfield
