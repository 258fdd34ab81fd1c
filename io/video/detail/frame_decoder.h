#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/detail/libav.h"
#include "io/images/picture.h"
#include "io/video/detail/packet_index.h"

namespace grainfield::io {

/// A frame of a video, or why it cannot be had.
struct DecodedFrame {
    Picture picture;
    std::string damage;  ///< what the decoder said; empty if the picture is sound
};

/// Random access to the frames of a video stream.
///
/// Packets are numbered in order of decoding, frames in order of presentation; `order()` maps one
/// to the other. The decoder is handed packet numbers in place of time stamps and gives them back
/// with the pictures, however it reorders them. Frame after frame costs one decoded packet each;
/// a jump costs those since the key frame before. Damage of a packet is passed on to all that
/// follow it up to the next key frame, unless nothing can depend on it.
class FrameDecoder {
 public:
    /// Opens the file and reads through all packets once; throws InputError.
    FrameDecoder(const std::filesystem::path& path, std::int64_t max_pixels);

    const PacketIndex& index() const { return index_; }
    const AVStream& stream() const { return *container_->streams[static_cast<unsigned>(stream_)]; }
    /// Whether the container keeps time at all; a bare H.264 stream, say, does not: what libav then
    /// reports comes from its default of 25 frames per second.
    bool has_clock() const;
    /// [1/s] as written into the coded pictures read so far; 0/1 if it is not.
    AVRational coded_frame_rate() const { return decoder_->framerate; }
    /// Packet number of each frame, in order of presentation.
    const std::vector<std::size_t>& order() const { return order_; }

    DecodedFrame read(std::size_t frame);

 private:
    void open();
    void find_order();
    void find_order_by_decoding();
    void number_frames();
    bool is_in_flight(std::size_t frame) const;
    void seek_to_key(std::size_t key);
    bool land_on(std::size_t key);
    void skip_from_start_to(std::size_t key);
    bool next_stream_packet();
    bool decode_next();
    void collect_pictures();
    void note_damage(std::size_t packet, const std::string& message);
    std::string damage_of(std::size_t packet) const;
    bool is_key(std::size_t packet) const;

    std::filesystem::path path_;
    std::int64_t max_pixels_;
    LibavLog log_;
    LibavPointer<AVFormatContext> container_;
    int stream_ = -1;
    LibavPointer<AVCodecContext> decoder_;
    LibavPointer<AVPacket> packet_{av_packet_alloc()};
    PacketIndex index_;
    std::vector<std::size_t> order_;     ///< packet of each frame
    std::vector<std::size_t> frame_of_;  ///< frame of each packet
    std::vector<std::size_t> key_of_;    ///< where decoding must start to get each packet right
    std::size_t started_ = 0;            ///< packet that decoding started from
    std::size_t next_packet_ = 0;        ///< to be decoded next
    bool packet_waits_ = false;          ///< packet_ holds next_packet_ already
    bool drained_ = false;               ///< the decoder has given its last picture
    std::vector<std::size_t> outputs_;   ///< packets whose pictures came since the last look
    std::size_t pictures_ended_ = 0;     ///< frames before this one will not come any more
    std::map<std::size_t, LibavPointer<AVFrame>> decoded_;  ///< by frame, not asked for yet
    std::map<std::size_t, std::string> damage_;             ///< by packet, since the last seek
};

}  // namespace grainfield::io
