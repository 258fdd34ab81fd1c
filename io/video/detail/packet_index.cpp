#include "io/video/detail/packet_index.h"

#include <limits>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

// Containers that hold their own data. Playlists (concat, hls, dash) could name any other file, and
// text or image demuxers would accept nearly anything.
constexpr const char* known_containers =
    "asf,avi,cine,dv,flv,gif,h264,hevc,ivf,m4v,matroska,webm,mjpeg,mov,mp4,m4a,3gp,3g2,mj2,mpeg,"
    "mpegts,mpegvideo,mxf,nut,ogg,yuv4mpegpipe,apng";

constexpr std::size_t ambiguous = std::numeric_limits<std::size_t>::max();

std::string explain(LibavLog& log, int code) {
    const std::string message = log.take();
    return message.empty() ? libav_error(code) : message;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& actual) {
    throw InputError(
        {.problem = fmt::format("cannot read '{}' as images or video", path.string()),
         .actual = fmt::format("{}; it starts with '{}'", actual, printable(read_head(path, 16))),
         .expected = "PNG, TIFF, JPEG, BMP, PNM or a video (AVI, Matroska, MP4, cine, …)",
         .suggestion = "check that the file is what its name says and was copied completely"});
}

class Dictionary {
 public:
    Dictionary() = default;
    Dictionary(const Dictionary&) = delete;
    Dictionary& operator=(const Dictionary&) = delete;
    ~Dictionary() { av_dict_free(&entries_); }
    void set(const char* key, const std::string& value) {
        av_dict_set(&entries_, key, value.c_str(), 0);
    }
    AVDictionary** get() { return &entries_; }

 private:
    AVDictionary* entries_ = nullptr;
};

// Some stream parameters are known only from the first frames, which libav decodes here.
void complete_stream_parameters(AVFormatContext& container, std::int64_t max_pixels) {
    std::vector<AVDictionary*> options(container.nb_streams, nullptr);
    for (AVDictionary*& entry : options) {
        av_dict_set(&entry, "max_pixels", std::to_string(max_pixels).c_str(), 0);
    }
    const std::size_t count = options.size();
    avformat_find_stream_info(&container, options.empty() ? nullptr : options.data());
    for (std::size_t i = 0; i < count; ++i) av_dict_free(&options[i]);
}

}  // namespace

void PacketIndex::make_lookup() {
    for (std::size_t i = 0; i < packets.size(); ++i) {
        const IndexedPacket& packet = packets[i];
        // A place or time that occurs twice identifies nothing.
        if (packet.position >= 0 && !by_position_.try_emplace(packet.position, i).second) {
            by_position_[packet.position] = ambiguous;
        }
        if (packet.dts != AV_NOPTS_VALUE && !by_dts_.try_emplace(packet.dts, i).second) {
            by_dts_[packet.dts] = ambiguous;
        }
    }
}

std::optional<std::size_t> PacketIndex::find(const AVPacket& packet) const {
    const bool by_place = packet.pos >= 0;
    const auto& lookup = by_place ? by_position_ : by_dts_;
    const auto found = lookup.find(by_place ? packet.pos : packet.dts);
    if (found == lookup.end() || found->second == ambiguous) return std::nullopt;
    if (packets[found->second].size != packet.size) return std::nullopt;
    return found->second;
}

LibavPointer<AVFormatContext> open_container(const std::filesystem::path& path, LibavLog& log,
                                             std::int64_t max_pixels, int& stream) {
    require_input_file(path);
    AVFormatContext* raw = avformat_alloc_context();
    if (raw == nullptr) throw std::bad_alloc();
    raw->opaque = &log;
    Dictionary options;
    options.set("format_whitelist", known_containers);
    options.set("protocol_whitelist", "file");
    // The prefix keeps a colon in the name from being taken for a protocol.
    const std::string url = "file:" + path.string();
    int code = unless_out_of_memory(avformat_open_input(&raw, url.c_str(), nullptr, options.get()));
    if (code < 0) refuse(path, explain(log, code));  // frees the context itself
    LibavPointer<AVFormatContext> container(raw);

    complete_stream_parameters(*container, max_pixels);
    stream = av_find_best_stream(container.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (stream < 0) refuse(path, "there is no video in it");
    const AVCodecParameters& parameters =
        *container->streams[static_cast<unsigned>(stream)]->codecpar;
    require_pixel_count(path, parameters.width, parameters.height, max_pixels);
    for (unsigned i = 0; i < container->nb_streams; ++i) {
        if (static_cast<int>(i) != stream) container->streams[i]->discard = AVDISCARD_ALL;
    }
    return container;
}

PacketIndex index_packets(AVFormatContext& container, int stream, LibavLog& log) {
    PacketIndex index;
    const LibavPointer<AVPacket> packet(av_packet_alloc());
    if (!packet) throw std::bad_alloc();
    int code = 0;
    while ((code = unless_out_of_memory(av_read_frame(&container, packet.get()))) >= 0) {
        const bool counts = packet->stream_index == stream && packet->size > 0 &&
                            (packet->flags & AV_PKT_FLAG_DISCARD) == 0;
        if (counts) {
            index.packets.push_back({.pts = packet->pts,
                                     .dts = packet->dts,
                                     .position = packet->pos,
                                     .size = packet->size,
                                     .flags = packet->flags});
            index.all_have_pts = index.all_have_pts && packet->pts != AV_NOPTS_VALUE;
        }
        av_packet_unref(packet.get());
    }
    index.cut_message = log.take();
    if (code != AVERROR_EOF && index.cut_message.empty()) index.cut_message = libav_error(code);
    if (!index.packets.empty() && (index.packets.back().flags & AV_PKT_FLAG_CORRUPT) != 0) {
        index.packets.pop_back();
        if (index.cut_message.empty()) index.cut_message = "the last frame is incomplete";
    }
    index.make_lookup();
    return index;
}

}  // namespace grainfield::io
