#pragma once

#include <optional>

namespace grainfield::io {

/// Time stamps of the first and last frame [s], and the mean time between two frames.
struct FrameStamps {
    double first = 0;
    double last = 0;
    double interval = 0;
};

/// A frame source whose file keeps time from a beginning that other files of a recording may share.
class FrameClock {
 public:
    virtual ~FrameClock() = default;
    /// Empty where frames have no time stamps, or there are fewer than two.
    virtual std::optional<FrameStamps> stamps() const = 0;
};

}  // namespace grainfield::io
