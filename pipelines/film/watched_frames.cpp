#include "pipelines/film/watched_frames.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::pipelines {

WatchedFrames::WatchedFrames(std::unique_ptr<FrameSource> source, BadFrames bad_frames)
    : source_(std::move(source)), bad_frames_(bad_frames) {
    if (bad_frames_ == BadFrames::allow || warnings().empty()) return;
    throw InputError({.problem = fmt::format("'{}' is not sound", name()),
                      .actual = warnings().front(),
                      .expected = {},
                      .suggestion = "leave out option 'strict' to use what can be read"});
}

Frame WatchedFrames::read(std::int64_t position) {
    Frame frame = source_->read(position);
    if (bad_frames_ == BadFrames::refuse && frame.status != FrameStatus::ok) {
        throw InputError(
            {.problem = fmt::format("frame {} of '{}' is {}", frame.index, name(),
                                    frame.status == FrameStatus::corrupt ? "corrupt" : "missing"),
             .actual = frame.message,
             .expected = {},
             .suggestion = "leave out option 'strict' to track the other frames"});
    }
    return frame;
}

PreviewChoice::PreviewChoice(std::int64_t wanted, std::int64_t count) {
    const std::int64_t n = std::min(wanted, count);
    for (std::int64_t i = 0; i < n; ++i) {
        positions_.push_back(n == 1 ? 0 : i * (count - 1) / (n - 1));
    }
}

void PreviewChoice::begin_at(std::int64_t position) {
    while (next_ < positions_.size() && positions_[next_] < position) ++next_;
}

bool PreviewChoice::takes(std::int64_t position) {
    if (next_ == positions_.size() || position < positions_[next_]) return false;
    while (next_ < positions_.size() && positions_[next_] <= position) ++next_;
    return true;
}

}  // namespace grainfield::pipelines
