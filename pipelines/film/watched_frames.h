#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/frame_source.h"

namespace grainfield::pipelines {

enum class BadFrames { allow, refuse };

/// Passes frames through and, if bad frames are refused, throws InputError for the first one that
/// is corrupt or missing.
class WatchedFrames : public FrameSource {
 public:
    WatchedFrames(std::unique_ptr<FrameSource> source, BadFrames bad_frames);

    std::int64_t count() const override { return source_->count(); }
    int width() const override { return source_->width(); }
    int height() const override { return source_->height(); }
    int bit_depth() const override { return source_->bit_depth(); }
    std::optional<double> frame_rate() const override { return source_->frame_rate(); }
    Frame read(std::int64_t position) override;
    std::string name() const override { return source_->name(); }
    const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 private:
    std::unique_ptr<FrameSource> source_;
    BadFrames bad_frames_;
};

/// Chooses frames to keep for people: `wanted` positions spread evenly from the first to the last
/// of `count`. Where a chosen frame is bad, the next good one takes its place.
class PreviewChoice {
 public:
    PreviewChoice(std::int64_t wanted, std::int64_t count);

    /// Whether the good frame at `position` is to be kept; positions come in increasing order.
    bool takes(std::int64_t position);
    /// Frames before this one are chosen by others.
    void begin_at(std::int64_t position);

 private:
    std::vector<std::int64_t> positions_;
    std::size_t next_ = 0;
};

}  // namespace grainfield::pipelines
