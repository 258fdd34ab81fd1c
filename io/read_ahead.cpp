#include "io/read_ahead.h"

#include <future>
#include <utility>

namespace grainfield::io {
namespace {

class ReadAhead : public FrameSource {
 public:
    explicit ReadAhead(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

    std::int64_t count() const override { return source_->count(); }
    int width() const override { return source_->width(); }
    int height() const override { return source_->height(); }
    int bit_depth() const override { return source_->bit_depth(); }
    std::optional<double> frame_rate() const override { return source_->frame_rate(); }
    std::string name() const override { return source_->name(); }
    const std::vector<std::string>& warnings() const override { return source_->warnings(); }

    Frame read(std::int64_t index) override {
        Frame frame = take(index);
        if (index + 1 < source_->count()) {
            ahead_ = index + 1;
            under_way_ = std::async(std::launch::async,
                                    [this, next = ahead_] { return source_->read(next); });
        }
        return frame;
    }

 private:
    Frame take(std::int64_t index) {
        if (under_way_.valid()) {
            if (ahead_ == index) return under_way_.get();
            // Whatever became of it, nobody asked.
            under_way_.wait();
            under_way_ = {};
        }
        return source_->read(index);
    }

    std::unique_ptr<FrameSource> source_;
    std::int64_t ahead_ = -1;
    std::future<Frame> under_way_;  // waits for its thread before the source goes
};

}  // namespace

std::unique_ptr<FrameSource> read_ahead(std::unique_ptr<FrameSource> source) {
    return std::make_unique<ReadAhead>(std::move(source));
}

}  // namespace grainfield::io
