#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/frame_source.h"

namespace grainfield::io {

/// The frames of another source: base of those that select, change or fetch them.
class PassedFrames : public FrameSource {
 public:
    explicit PassedFrames(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

    std::int64_t count() const override { return source_->count(); }
    int width() const override { return source_->width(); }
    int height() const override { return source_->height(); }
    int bit_depth() const override { return source_->bit_depth(); }
    std::optional<double> frame_rate() const override { return source_->frame_rate(); }
    std::string name() const override { return source_->name(); }
    const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 protected:
    FrameSource& source() const { return *source_; }

 private:
    std::unique_ptr<FrameSource> source_;
};

}  // namespace grainfield::io
