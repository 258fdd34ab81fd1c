#include "io/video/detail/frame_decoder.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

extern "C" {
#include <libavutil/opt.h>
}

#include "core/errors.h"

namespace grainfield::io {

namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

bool codec_reorders(AVCodecID codec) {
    const AVCodecDescriptor* descriptor = avcodec_descriptor_get(codec);
    return descriptor != nullptr && (descriptor->props & AV_CODEC_PROP_REORDER) != 0;
}

}  // namespace

FrameDecoder::FrameDecoder(const std::filesystem::path& path, std::int64_t max_pixels)
    : path_(path), max_pixels_(max_pixels) {
    if (!packet_) throw std::bad_alloc();
    open();
    index_ = index_packets(*container_, stream_, log_);
    index_.all_have_pts = index_.all_have_pts && has_clock();
    try {
        decoder_ = open_decoder(*stream().codecpar, log_, max_pixels_);
    } catch (const Error& error) {
        throw InputError({.problem = fmt::format("cannot decode '{}'", path_.string()),
                          .actual = error.what(),
                          .expected = "a codec of libavcodec",
                          .suggestion = "convert it with: ffmpeg -i IN -c:v ffv1 OUT.mkv"});
    }
    find_order();
}

void FrameDecoder::open() {
    container_ = open_container(path_, log_, max_pixels_, stream_);
    log_.take();
}

bool FrameDecoder::has_clock() const {
    // The demuxers of bare streams are those that let the user set the rate.
    const AVInputFormat& format = *container_->iformat;
    return (format.flags & AVFMT_NOTIMESTAMPS) == 0 &&
           (format.priv_class == nullptr ||
            av_opt_find(const_cast<AVClass const**>(&format.priv_class), "framerate", nullptr, 0,
                        AV_OPT_SEARCH_FAKE_OBJ) == nullptr);
}

bool FrameDecoder::is_key(std::size_t packet) const {
    return packet == 0 || (index_.packets[packet].flags & AV_PKT_FLAG_KEY) != 0;
}

void FrameDecoder::find_order() {
    order_.resize(index_.packets.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const bool reorders = codec_reorders(stream().codecpar->codec_id);
    if (reorders && index_.all_have_pts) {
        std::stable_sort(order_.begin(), order_.end(), [this](std::size_t a, std::size_t b) {
            return index_.packets[a].pts < index_.packets[b].pts;
        });
    }
    number_frames();
    if (order_.empty()) return;
    if (reorders && !index_.all_have_pts) {
        find_order_by_decoding();
        number_frames();
    }
    // The next read starts from a defined place.
    drained_ = true;
    pictures_ended_ = none;
}

void FrameDecoder::find_order_by_decoding() {
    seek_to_key(0);
    std::vector<std::size_t> order;
    std::vector<bool> seen(index_.packets.size(), false);
    while (decode_next()) {
        for (const std::size_t packet : std::exchange(outputs_, {})) {
            if (!seen[packet]) order.push_back(packet);
            seen[packet] = true;
        }
        decoded_.clear();
    }
    order_ = std::move(order);
}

void FrameDecoder::number_frames() {
    const std::size_t packets = index_.packets.size();
    frame_of_.assign(packets, none);
    for (std::size_t frame = 0; frame < order_.size(); ++frame) frame_of_[order_[frame]] = frame;
    // Pictures shown before the key picture that they follow in the file need the one before, too.
    key_of_.assign(packets, 0);
    std::size_t key = 0;
    std::size_t key_before = 0;
    for (std::size_t packet = 0; packet < packets; ++packet) {
        if (is_key(packet)) key_before = std::exchange(key, packet);
        key_of_[packet] = frame_of_[packet] < frame_of_[key] ? key_before : key;
    }
}

bool FrameDecoder::is_in_flight(std::size_t frame) const {
    const std::size_t packet = order_[frame];
    return !drained_ && frame >= pictures_ended_ && key_of_[packet] >= started_ &&
           key_of_[packet] <= next_packet_;
}

DecodedFrame FrameDecoder::read(std::size_t frame) {
    const std::size_t packet = order_[frame];
    decoded_.erase(decoded_.begin(), decoded_.lower_bound(frame));
    if (!decoded_.contains(frame) && !is_in_flight(frame)) seek_to_key(key_of_[packet]);
    while (!decoded_.contains(frame) && pictures_ended_ <= frame && decode_next()) {
        decoded_.erase(decoded_.begin(), decoded_.lower_bound(frame));
    }
    outputs_.clear();
    const auto found = decoded_.find(frame);
    DecodedFrame result;
    result.damage = damage_of(packet);
    if (found == decoded_.end()) {
        if (result.damage.empty()) result.damage = "the decoder gave no picture";
        return result;
    }
    if (result.damage.empty()) result.picture = to_grey(path_, *found->second);
    decoded_.erase(found);
    return result;
}

void FrameDecoder::seek_to_key(std::size_t key) {
    // A flush keeps what damaged packets left behind (MPEG-4), which pictures would then depend on.
    decoder_ = open_decoder(*stream().codecpar, log_, max_pixels_);
    decoded_.clear();
    damage_.clear();
    outputs_.clear();
    drained_ = false;
    pictures_ended_ = 0;
    started_ = key;
    if (!land_on(key)) skip_from_start_to(key);
    next_packet_ = key;
}

bool FrameDecoder::land_on(std::size_t key) {
    const IndexedPacket& target = index_.packets[key];
    const std::int64_t time = target.dts != AV_NOPTS_VALUE ? target.dts : target.pts;
    if (time == AV_NOPTS_VALUE) return false;
    if (av_seek_frame(container_.get(), stream_, time, AVSEEK_FLAG_BACKWARD) < 0) return false;
    while (next_stream_packet()) {
        const auto number = index_.find(*packet_);
        if (!number || *number > key) return false;
        if (*number == key) {
            packet_waits_ = true;
            return true;
        }
    }
    return false;
}

void FrameDecoder::skip_from_start_to(std::size_t key) {
    open();
    packet_waits_ = false;
    for (std::size_t skipped = 0; skipped < key && next_stream_packet(); ++skipped) continue;
}

bool FrameDecoder::next_stream_packet() {
    packet_waits_ = false;
    while (true) {
        av_packet_unref(packet_.get());
        if (unless_out_of_memory(av_read_frame(container_.get(), packet_.get())) < 0) return false;
        if (packet_->stream_index == stream_ && packet_->size > 0 &&
            (packet_->flags & AV_PKT_FLAG_DISCARD) == 0) {
            return true;
        }
    }
}

bool FrameDecoder::decode_next() {
    if (drained_) return false;
    const bool have = next_packet_ < index_.packets.size() &&
                      (std::exchange(packet_waits_, false) || next_stream_packet());
    log_.take();  // what the container says was heard when the file was indexed
    if (!have) {
        avcodec_send_packet(decoder_.get(), nullptr);
        collect_pictures();
        drained_ = true;
        return !outputs_.empty();
    }
    const std::size_t number = next_packet_++;
    if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0) {
        note_damage(number, "the container marks this frame as incomplete");
    }
    packet_->pts = static_cast<std::int64_t>(number);
    packet_->dts = packet_->pts;
    const int code = unless_out_of_memory(avcodec_send_packet(decoder_.get(), packet_.get()));
    collect_pictures();
    const std::string message = log_.take();
    if (code < 0 || !message.empty()) {
        note_damage(number, message.empty() ? libav_error(code) : message);
    }
    return true;
}

void FrameDecoder::collect_pictures() {
    while (true) {
        LibavPointer<AVFrame> frame(av_frame_alloc());
        if (!frame) throw std::bad_alloc();
        const int code = unless_out_of_memory(avcodec_receive_frame(decoder_.get(), frame.get()));
        if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
        if (code < 0) {
            if (next_packet_ > 0) note_damage(next_packet_ - 1, libav_error(code));
            return;
        }
        if (frame->pts < 0 || frame->pts >= static_cast<std::int64_t>(frame_of_.size())) continue;
        const auto packet = static_cast<std::size_t>(frame->pts);
        outputs_.push_back(packet);
        if (frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
            note_damage(packet, "the decoder reports missing or invalid data");
        }
        if (frame_of_[packet] == none) continue;
        pictures_ended_ = std::max(pictures_ended_, frame_of_[packet] + 1);
        decoded_[frame_of_[packet]] = std::move(frame);
    }
}

void FrameDecoder::note_damage(std::size_t packet, const std::string& message) {
    damage_.try_emplace(packet, message);
}

std::string FrameDecoder::damage_of(std::size_t packet) const {
    const std::size_t key = key_of_[packet];
    for (auto it = damage_.lower_bound(key); it != damage_.end() && it->first < packet; ++it) {
        const bool passes_on = (index_.packets[it->first].flags & AV_PKT_FLAG_DISPOSABLE) == 0 &&
                               (key_of_[it->first] == key || is_key(it->first));
        if (passes_on) {
            return fmt::format("it builds on an earlier damaged frame: {}", it->second);
        }
    }
    const auto own = damage_.find(packet);
    return own == damage_.end() ? std::string() : own->second;
}

}  // namespace grainfield::io
