#pragma once

#include <cstdint>
#include <future>
#include <utility>

#include "core/frame_source.h"

namespace grainfield::tracking {

/// Frames in order, each decoded while the one before is worked on. One more frame is in memory;
/// nobody else may read from the source meanwhile.
class ReadAhead {
 public:
    /// Without `is_ahead` frames are read when they are asked for.
    ReadAhead(FrameSource& source, bool is_ahead) : source_(source), is_ahead_(is_ahead) {}

    /// FrameSource::read.
    Frame read(std::int64_t position) {
        Frame frame = position == expected_ ? next_.get() : source_.read(position);
        expected_ = kNone;
        if (is_ahead_ && position + 1 < source_.count()) {
            expected_ = position + 1;
            next_ = std::async(std::launch::async,
                               [this, wanted = expected_] { return source_.read(wanted); });
        }
        return frame;
    }

 private:
    static constexpr std::int64_t kNone = -1;

    FrameSource& source_;
    bool is_ahead_;
    std::int64_t expected_ = kNone;
    std::future<Frame> next_;  ///< waits for its thread when it goes
};

}  // namespace grainfield::tracking
