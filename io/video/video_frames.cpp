#include "io/video/video_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/frame_clock.h"
#include "io/video/detail/frame_decoder.h"
#include "io/video/detail/packet_index.h"

namespace grainfield::io {

namespace {

class VideoFrames : public FrameSource, public FrameClock {
 public:
    VideoFrames(std::filesystem::path path, const FrameFileOptions& options)
        : path_(std::move(path)),
          options_(options),
          video_(path_, options.max_pixels),
          count_(static_cast<std::int64_t>(video_.order().size())) {
        if (count_ == 0) {
            throw InputError({.problem = fmt::format("cannot read '{}'", path_.string()),
                              .actual = "no whole frame in it: " + video_.index().cut_message,
                              .expected = "at least one frame",
                              .suggestion = "copy the file again from where it was recorded"});
        }
        find_shape();
        check_length();
        check_times();
        frame_rate_ = options.fps ? options.fps : believable_rate();
    }

    std::int64_t count() const override { return count_; }
    int width() const override { return shape_.width; }
    int height() const override { return shape_.height; }
    int bit_depth() const override { return shape_.bit_depth; }
    std::optional<double> frame_rate() const override { return frame_rate_; }
    std::string name() const override { return path_.string(); }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    std::optional<FrameStamps> stamps() const override {
        if (count_ < 2 || !video_.index().all_have_pts || !video_.has_clock()) return std::nullopt;
        const double interval = stamp(count_ - 1) / static_cast<double>(count_ - 1);
        if (!(interval > 0)) return std::nullopt;
        const double first =
            static_cast<double>(packet_of(0).pts) * av_q2d(video_.stream().time_base);
        return FrameStamps{.first = first, .last = first + stamp(count_ - 1), .interval = interval};
    }

    Frame read(std::int64_t index) override {
        require_frame_index(index, count_, name());
        Frame frame;
        frame.index = index;
        frame.time = time_of(index);
        frame.bit_depth = shape_.bit_depth;
        DecodedFrame decoded = video_.read(static_cast<std::size_t>(index));
        if (!decoded.damage.empty()) {
            frame.status = FrameStatus::corrupt;
            frame.message = std::move(decoded.damage);
            return frame;
        }
        require_same_shape(path_, index, decoded.picture.shape(), shape_);
        frame.image = std::move(decoded.picture.image);
        return frame;
    }

 private:
    const IndexedPacket& packet_of(std::int64_t frame) const {
        return video_.index().packets[video_.order()[static_cast<std::size_t>(frame)]];
    }

    // From the first frame that can be decoded.
    void find_shape() {
        std::string first_damage;
        for (std::int64_t i = 0; i < count_; ++i) {
            const DecodedFrame decoded = video_.read(static_cast<std::size_t>(i));
            if (decoded.damage.empty()) {
                shape_ = decoded.picture.shape();
                return;
            }
            if (first_damage.empty()) first_damage = decoded.damage;
        }
        throw CorruptPicture(
            path_, fmt::format("none of {} frames can be decoded: {}", count_, first_damage));
    }

    void check_length() {
        const std::int64_t declared = video_.stream().nb_frames;
        const std::string& reason = video_.index().cut_message;
        if (reason.empty() && declared <= count_) return;
        std::string text = fmt::format("'{}' is cut short: {} whole frames", name(), count_);
        if (declared > count_) text += fmt::format(" of {} declared", declared);
        if (!reason.empty()) text += ", " + reason;
        warnings_.push_back(std::move(text));
    }

    void check_times() {
        if (!video_.index().all_have_pts) return;
        for (std::int64_t i = 1; i < count_; ++i) {
            if (packet_of(i).pts > packet_of(i - 1).pts) continue;
            warnings_.push_back(fmt::format(
                "the time stamps of '{}' do not increase at frame {}; frames keep their order in "
                "the file and their stamps",
                name(), i));
            return;
        }
    }

    double stamp(std::int64_t frame) const {
        return static_cast<double>(packet_of(frame).pts - packet_of(0).pts) *
               av_q2d(video_.stream().time_base);
    }

    double time_of(std::int64_t frame) const {
        if (options_.fps) return static_cast<double>(frame) / *options_.fps;
        if (!frame_rate_) return static_cast<double>(frame);
        if (!video_.index().all_have_pts) return static_cast<double>(frame) / *frame_rate_;
        return stamp(frame);
    }

    std::optional<double> believable_rate() {
        const AVRational declared =
            video_.has_clock() ? video_.stream().avg_frame_rate : video_.coded_frame_rate();
        if (declared.num <= 0 || declared.den <= 0) return std::nullopt;
        const double rate = av_q2d(declared);
        if (!std::isfinite(rate) || rate > 1e7) return std::nullopt;
        if (!video_.index().all_have_pts || count_ < 3) return rate;
        const double span = stamp(count_ - 1);
        const double expected = static_cast<double>(count_ - 1) / rate;
        // One frame of slack: the average may count the duration of the last frame or not.
        if (std::abs(span - expected) <= std::max(1.0 / rate, 0.02 * expected)) return rate;
        warnings_.push_back(fmt::format(
            "'{}' declares {:.6g} frames per second, its time stamps span {:.6g} s for {} frames; "
            "the frame rate is taken as unknown",
            name(), rate, span, count_));
        return std::nullopt;
    }

    std::filesystem::path path_;
    FrameFileOptions options_;
    FrameDecoder video_;
    std::int64_t count_;
    PictureShape shape_;
    std::optional<double> frame_rate_;
    std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<FrameSource> open_video(const std::filesystem::path& path,
                                        const FrameFileOptions& options) {
    return std::make_unique<VideoFrames>(path, options);
}

}  // namespace grainfield::io
