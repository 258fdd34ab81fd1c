#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame.h"

namespace grainfield {

/// Frames in a row, by their positions in a source; `end` is excluded.
struct FrameSpan {
    std::int64_t begin = 0, end = 0;

    std::int64_t size() const { return end - begin; }
    friend bool operator==(const FrameSpan&, const FrameSpan&) = default;
};

/// Where frames come from: files, a video, a renderer, a test.
///
/// `read` may be called with any index in any order; sources are not thread-safe.
class FrameSource {
 public:
    virtual ~FrameSource() = default;

    /// Number of frames, verified by the source rather than believed from a header.
    virtual std::int64_t count() const = 0;
    virtual int width() const = 0;
    virtual int height() const = 0;
    virtual int bit_depth() const = 0;

    /// [1/s]; empty if the source does not know (never a guess).
    virtual std::optional<double> frame_rate() const = 0;

    /// Frame `index`. A frame that cannot be decoded comes back with its status and message set,
    /// it does not throw. Throws OptionError when index is outside [0, count()).
    virtual Frame read(std::int64_t index) = 0;

    /// What to call this source in messages and in the record of the run.
    virtual std::string name() const = 0;

    /// What was noticed on opening: a truncated file, gaps in numbering, non-monotonic times.
    virtual const std::vector<std::string>& warnings() const = 0;
};

}  // namespace grainfield
