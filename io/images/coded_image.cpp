#include "io/images/coded_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "io/detail/libav.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

AVCodecID pnm_codec(std::string_view content) {
    switch (content.size() > 1 ? content[1] : '5') {
        case '1':
        case '4':
            return AV_CODEC_ID_PBM;
        case '2':
        case '5':
            return AV_CODEC_ID_PGM;
        default:
            return AV_CODEC_ID_PPM;
    }
}

// The decoder fills what is absent with grey and only warns.
void require_end_marker(const std::filesystem::path& path, std::string_view jpeg) {
    constexpr std::size_t padding = 4096;
    const std::string_view tail = jpeg.substr(jpeg.size() - std::min(jpeg.size(), padding));
    if (tail.rfind("\xff\xd9") == std::string_view::npos) {
        throw CorruptPicture(path, "the JPEG ends without its end marker");
    }
}

/// The largest count a PNM header declares; 255 if there is none.
int pnm_maximum(std::string_view content) {
    int field = 0;
    int value = 0;
    bool inside = false;
    for (std::size_t i = 2; i < content.size(); ++i) {
        const char c = content[i];
        if (c == '#') {
            while (i < content.size() && content[i] != '\n') ++i;
        } else if (c >= '0' && c <= '9' && value < 100'000) {
            value = 10 * value + (c - '0');
            inside = true;
            continue;
        }
        if (inside && ++field == 3) return value;
        inside = false;
        value = 0;
    }
    return 255;
}

/// libavcodec stretches the counts of a PNM to the full 8 or 16 bit; this takes it back. Exact up
/// to a maximum of 16383 (14 bit): the stretched value is within 1 of count · full / maximum, and
/// full / maximum is then more than 2.
void restore_counts(std::string_view content, Picture& picture) {
    const int maximum = pnm_maximum(content);
    const int full = (1 << picture.bit_depth) - 1;
    if (maximum < 1 || maximum >= full) return;
    for (float& count : picture.image.pixels()) {
        count = std::round(count * static_cast<float>(maximum) / static_cast<float>(full));
    }
    picture.bit_depth = static_cast<int>(std::bit_width(static_cast<unsigned>(maximum)));
}

struct ParametersDeleter {
    void operator()(AVCodecParameters* p) const { avcodec_parameters_free(&p); }
};

LibavPointer<AVPacket> make_packet(std::string_view content) {
    LibavPointer<AVPacket> packet(av_packet_alloc());
    if (!packet || av_new_packet(packet.get(), static_cast<int>(content.size())) < 0) {
        throw std::bad_alloc();
    }
    std::memcpy(packet->data, content.data(), content.size());
    return packet;
}

std::string coded_content(const std::filesystem::path& path) {
    require_input_file(path);
    return read_content(path, std::size_t{1} << 30U);
}

Picture decode(const std::filesystem::path& path, std::string_view content, AVCodecID codec,
               std::int64_t max_pixels) {
    const std::unique_ptr<AVCodecParameters, ParametersDeleter> parameters(
        avcodec_parameters_alloc());
    parameters->codec_type = AVMEDIA_TYPE_VIDEO;
    parameters->codec_id = codec;
    LibavLog log;
    const auto decoder = open_decoder(*parameters, log, max_pixels);
    const auto packet = make_packet(content);
    const LibavPointer<AVFrame> frame(av_frame_alloc());
    int code = avcodec_send_packet(decoder.get(), packet.get());
    if (code >= 0) code = avcodec_send_packet(decoder.get(), nullptr);
    if (code >= 0) code = avcodec_receive_frame(decoder.get(), frame.get());
    if (decoder->width > 0 && decoder->height > 0) {
        require_pixel_count(path, decoder->width, decoder->height, max_pixels);
    }
    unless_out_of_memory(code);
    const std::string message = log.take();
    if (code < 0 || !message.empty() || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
        throw CorruptPicture(path, message.empty() ? libav_error(code) : message);
    }
    return to_grey(path, *frame);
}

bool is_jpeg(std::string_view head) {
    return head.starts_with("\xff\xd8\xff");
}

Picture read_jpeg(const std::filesystem::path& path, std::int64_t max_pixels) {
    const std::string content = coded_content(path);
    require_end_marker(path, content);
    return decode(path, content, AV_CODEC_ID_MJPEG, max_pixels);
}

// The two reserved words of a BMP header are zero: "BM" alone would match text.
bool is_bmp(std::string_view head) {
    using namespace std::string_view_literals;
    return head.starts_with("BM") && head.size() >= 10 && head.substr(6, 4) == "\0\0\0\0"sv;
}

Picture read_bmp(const std::filesystem::path& path, std::int64_t max_pixels) {
    return decode(path, coded_content(path), AV_CODEC_ID_BMP, max_pixels);
}

bool is_pnm(std::string_view head) {
    return head.size() >= 3 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6' &&
           std::string_view(" \t\r\n").find(head[2]) != std::string_view::npos;
}

Picture read_pnm(const std::filesystem::path& path, std::int64_t max_pixels) {
    const std::string content = coded_content(path);
    Picture picture = decode(path, content, pnm_codec(content), max_pixels);
    restore_counts(content, picture);
    return picture;
}

}  // namespace

ImageFormat jpeg_format() {
    return {.name = "JPEG", .recognises = is_jpeg, .read = read_jpeg};
}

ImageFormat bmp_format() {
    return {.name = "BMP", .recognises = is_bmp, .read = read_bmp};
}

ImageFormat pnm_format() {
    return {.name = "PNM", .recognises = is_pnm, .read = read_pnm};
}

}  // namespace grainfield::io
