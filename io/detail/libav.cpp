#include "io/detail/libav.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>

extern "C" {
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
}

namespace grainfield::io {

namespace {

LibavLog* owner_of(void* context) {
    if (context == nullptr) return nullptr;
    const AVClass* kind = *static_cast<const AVClass**>(context);
    if (kind == avcodec_get_class()) {
        return static_cast<LibavLog*>(static_cast<AVCodecContext*>(context)->opaque);
    }
    if (kind == avformat_get_class()) {
        return static_cast<LibavLog*>(static_cast<AVFormatContext*>(context)->opaque);
    }
    return nullptr;
}

void keep_message(void* context, int level, const char* format, va_list arguments) {
    if (level > AV_LOG_ERROR) return;
    LibavLog* log = owner_of(context);
    if (log == nullptr) return;
    std::array<char, 400> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    log->add(text.data());
}

void copy_plane(const AVFrame& frame, const AVComponentDescriptor& component, bool big_endian,
                Image& image) {
    const std::uint32_t mask = (1U << static_cast<unsigned>(component.depth)) - 1U;
    const auto shift = static_cast<unsigned>(component.shift);
    for (int y = 0; y < image.height(); ++y) {
        const std::uint8_t* in = frame.data[component.plane] +
                                 static_cast<std::ptrdiff_t>(y) * frame.linesize[component.plane] +
                                 component.offset;
        float* out = image.row(y);
        if (component.depth == 8 && component.shift == 0 && component.step == 1) {
            std::copy_n(in, image.width(), out);
            continue;
        }
        if (component.depth + component.shift <= 8) {
            for (int x = 0; x < image.width(); ++x, in += component.step) {
                out[x] = static_cast<float>((static_cast<unsigned>(*in) >> shift) & mask);
            }
            continue;
        }
        const int high = big_endian ? 0 : 1;
        for (int x = 0; x < image.width(); ++x, in += component.step) {
            const std::uint32_t word = static_cast<std::uint32_t>(in[high]) << 8U | in[1 - high];
            out[x] = static_cast<float>((word >> shift) & mask);
        }
    }
}

/// One row of one component, whatever the packing.
void read_component(const AVFrame& frame, const AVPixFmtDescriptor& format, int y, int component,
                    std::vector<std::uint16_t>& row) {
    std::array<const std::uint8_t*, 4> data{frame.data[0], frame.data[1], frame.data[2],
                                            frame.data[3]};
    av_read_image_line(row.data(), data.data(), frame.linesize, &format, 0, y, component,
                       static_cast<int>(row.size()), 0);
}

// A palette has 256 native words 0xAARRGGBB.
void look_up_palette(const AVFrame& frame, Image& image) {
    std::array<std::uint32_t, 256> words{};
    std::memcpy(words.data(), frame.data[1], sizeof(words));
    std::array<float, 256> grey{};
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto channel = [word = words[i]](unsigned shift) {
            return static_cast<std::int32_t>((word >> shift) & 255U);
        };
        grey[i] = luma(channel(16), channel(8), channel(0));
    }
    for (int y = 0; y < image.height(); ++y) {
        const std::uint8_t* in = frame.data[0] + static_cast<std::ptrdiff_t>(y) * frame.linesize[0];
        float* out = image.row(y);
        for (int x = 0; x < image.width(); ++x) out[x] = grey[in[x]];
    }
}

void reduce_colour(const AVFrame& frame, const AVPixFmtDescriptor& format, Image& image) {
    std::array<std::vector<std::uint16_t>, 3> rows;
    for (auto& row : rows) row.resize(static_cast<std::size_t>(image.width()));
    for (int y = 0; y < image.height(); ++y) {
        for (int c = 0; c < 3; ++c) {
            read_component(frame, format, y, c, rows[static_cast<std::size_t>(c)]);
        }
        float* out = image.row(y);
        for (std::size_t x = 0; x < rows[0].size(); ++x) {
            out[x] = luma(rows[0][x], rows[1][x], rows[2][x]);
        }
    }
}

}  // namespace

LibavLog::LibavLog() {
    static std::once_flag once;
    std::call_once(once, [] { av_log_set_callback(keep_message); });
}

void LibavLog::add(const char* text) {
    const std::lock_guard lock(mutex_);
    if (text_.size() < 400) text_ += text;
}

std::string LibavLog::take() {
    const std::lock_guard lock(mutex_);
    std::string line = std::exchange(text_, {});
    if (line.find("whitelist") != std::string::npos) {
        return "it refers to other files or to the network, or is a list of files; none of these "
               "is followed";
    }
    while (!line.empty() && (line.back() == '\n' || line.back() == ' ')) line.pop_back();
    for (std::size_t at = 0; (at = line.find('\n', at)) != std::string::npos;) {
        line.replace(at, 1, "; ");
    }
    return line;
}

std::string libav_error(int code) {
    if (code == AVERROR(ENOMEM)) return "it declares a size that cannot be allocated";
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return text.data();
}

int unless_out_of_memory(int code) {
    if (code != AVERROR(ENOMEM)) return code;
    // libav says the same of a damaged file that declares a block of many gigabytes.
    constexpr std::size_t enough = std::size_t{1} << 28;
    void* const block = ::operator new(enough, std::nothrow);
    if (block == nullptr) throw std::bad_alloc();
    ::operator delete(block);
    return code;
}

LibavPointer<AVCodecContext> open_decoder(const AVCodecParameters& parameters, LibavLog& log,
                                          std::int64_t max_pixels) {
    const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
    if (codec == nullptr) {
        throw Error(
            fmt::format("there is no decoder for '{}'", avcodec_get_name(parameters.codec_id)));
    }
    LibavPointer<AVCodecContext> context(avcodec_alloc_context3(codec));
    if (!context) throw std::bad_alloc();
    int code = unless_out_of_memory(avcodec_parameters_to_context(context.get(), &parameters));
    if (code < 0) throw Error(libav_error(code));
    context->opaque = &log;
    context->max_pixels = std::min<std::int64_t>(max_pixels, std::numeric_limits<int>::max());
    context->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER;
    context->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
    context->thread_type = FF_THREAD_SLICE;
    context->thread_count = 0;
    code = unless_out_of_memory(avcodec_open2(context.get(), codec, nullptr));
    if (code < 0) {
        const std::string message = log.take();
        throw Error(message.empty() ? libav_error(code) : message);
    }
    return context;
}

Picture to_grey(const std::filesystem::path& path, const AVFrame& frame) {
    const AVPixFmtDescriptor* format =
        av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    const std::uint64_t unusable =
        AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BAYER;
    if (format == nullptr || (format->flags & unusable) != 0 || format->comp[0].depth > 16) {
        throw InputError({.problem = fmt::format("cannot use the pixels of '{}'", path.string()),
                          .actual = format == nullptr ? "an unknown pixel format" : format->name,
                          .expected = "grey, YUV or RGB of at most 16 bit",
                          .suggestion = "convert it with: ffmpeg -i IN -pix_fmt gray16le "
                                        "-c:v ffv1 OUT.mkv"});
    }
    const bool palette = (format->flags & AV_PIX_FMT_FLAG_PAL) != 0;
    const bool colour = (format->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    Picture picture{Image(frame.width, frame.height), palette ? 8 : format->comp[0].depth};
    if (palette) {
        look_up_palette(frame, picture.image);
    } else if (colour && format->nb_components >= 3) {
        reduce_colour(frame, *format, picture.image);
    } else if ((format->flags & AV_PIX_FMT_FLAG_BITSTREAM) != 0) {
        std::vector<std::uint16_t> row(static_cast<std::size_t>(frame.width));
        for (int y = 0; y < frame.height; ++y) {
            read_component(frame, *format, y, 0, row);
            std::copy(row.begin(), row.end(), picture.image.row(y));
        }
    } else {
        const bool big_endian = (format->flags & AV_PIX_FMT_FLAG_BE) != 0;
        copy_plane(frame, format->comp[0], big_endian, picture.image);
    }
    return picture;
}

}  // namespace grainfield::io
