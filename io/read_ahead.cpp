#include "io/read_ahead.h"

#include <future>
#include <utility>

#include "io/passed_frames.h"

namespace grainfield::io {
namespace {

class ReadAhead : public PassedFrames {
 public:
    using PassedFrames::PassedFrames;

    Frame read(std::int64_t index) override {
        Frame frame = take(index);
        const bool goes_on = index == last_ + 1;
        last_ = index;
        if (goes_on && index + 1 < source().count()) {
            ahead_ = index + 1;
            under_way_ = std::async(std::launch::async,
                                    [this, next = ahead_] { return source().read(next); });
        }
        return frame;
    }

 private:
    Frame take(std::int64_t index) {
        if (under_way_.valid()) {
            if (ahead_ == index) return under_way_.get();
            // Its result or exception is not needed.
            under_way_.wait();
            under_way_ = {};
        }
        return source().read(index);
    }

    std::int64_t last_ = -1;
    std::int64_t ahead_ = -1;
    std::future<Frame> under_way_;  // waits for its thread before the source goes
};

}  // namespace

std::unique_ptr<FrameSource> read_ahead(std::unique_ptr<FrameSource> source) {
    return std::make_unique<ReadAhead>(std::move(source));
}

}  // namespace grainfield::io
