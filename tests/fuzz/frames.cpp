#include "tests/fuzz/frames.h"

#include <algorithm>
#include <cmath>

#include "tests/fuzz/input.h"

namespace grainfield::fuzz {

namespace {

constexpr std::int64_t kMost = 6;  // frames that are decoded

void require_sound(const Frame& frame, const FrameSource& frames) {
    if (frame.status != FrameStatus::ok) {
        promise(frame.image.empty() && !frame.message.empty(), "a bad frame says why");
        return;
    }
    promise(frame.image.width() == frames.width() && frame.image.height() == frames.height(),
            "all frames have one size");
    promise(frame.bit_depth >= 1 && frame.bit_depth <= 16, "1 to 16 bit");
    const float most = std::ldexp(1.0F, frame.bit_depth);
    promise(std::ranges::all_of(frame.image.pixels(),
                                [most](float count) { return count >= 0 && count < most; }),
            "counts fit the depth");
    promise(std::isfinite(frame.time), "a frame has a time");
}

}  // namespace

void read_some(FrameSource& frames) {
    promise(frames.width() > 0 && frames.height() > 0 && frames.count() > 0, "there is a frame");
    const std::int64_t count = std::min(frames.count(), kMost);
    Frame first;
    for (std::int64_t i = 0; i < count; ++i) {
        Frame frame = frames.read(i);
        require_sound(frame, frames);
        if (i == 0) first = std::move(frame);
    }
    const Frame again = frames.read(0);
    promise(again.status == first.status && again.image == first.image,
            "a frame is the same each time it is read");
}

}  // namespace grainfield::fuzz
