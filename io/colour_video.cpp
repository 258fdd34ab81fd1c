#include "io/colour_video.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <utility>

#include <fmt/format.h>

extern "C" {
#include <libavutil/opt.h>
}

#include "core/errors.h"
#include "io/libav.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

// The context that writes, unlike LibavDeleter's, which reads.
struct OutputDeleter {
    void operator()(AVFormatContext* context) const {
        avio_closep(&context->pb);
        avformat_free_context(context);
    }
};

const char* muxer_of(const fs::path& path) {
    const std::string extension = path.extension().string();
    if (extension == ".mp4") return "mp4";
    if (extension == ".mov") return "mov";
    return extension == ".mkv" ? "matroska" : nullptr;
}

std::uint8_t level(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

}  // namespace

class ColourVideo::Encoder {
 public:
    Encoder(const fs::path& path, const ColourVideoOptions& options, Overwrite overwrite)
        : options_(options), file_(path, overwrite) {
        open_encoder();
        open_file();
        packet_.reset(av_packet_alloc());
        frame_.reset(av_frame_alloc());
        if (!packet_ || !frame_) throw std::bad_alloc();
        frame_->format = encoder_->pix_fmt;
        frame_->width = encoder_->width;
        frame_->height = encoder_->height;
        check(av_frame_get_buffer(frame_.get(), 0));
    }

    void write(std::span<const std::uint8_t> rgb) {
        const auto expected = static_cast<std::size_t>(options_.width) *
                              static_cast<std::size_t>(options_.height) * 3;
        if (rgb.size() != expected) {
            throw OptionError({.problem = "a picture of the video has another size",
                               .actual = fmt::format("{} bytes", rgb.size()),
                               .expected = fmt::format("{}, as announced", expected),
                               .suggestion = {}});
        }
        check(av_frame_make_writable(frame_.get()));
        fill(rgb);
        frame_->pts = written_++;
        check(avcodec_send_frame(encoder_.get(), frame_.get()));
        drain();
    }

    void finish() {
        check(avcodec_send_frame(encoder_.get(), nullptr));
        drain();
        check(av_write_trailer(output_.get()));
        avio_flush(output_->pb);
        if (output_->pb->error < 0) check(output_->pb->error);
        output_.reset();
        file_.commit();
    }

 private:
    [[noreturn]] void fail(const std::string& reason) const {
        throw OutputError({.problem = fmt::format("cannot write '{}'", file_.target().string()),
                           .actual = reason,
                           .expected = {},
                           .suggestion = "check the free space and quota of that disk"});
    }
    void check(int code) const {
        if (code < 0) fail(libav_error(code));
    }

    void open_encoder() {
        const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
        if (codec == nullptr) codec = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
        if (codec == nullptr) fail("libavcodec has no encoder for H.264 or MPEG-4");
        encoder_.reset(avcodec_alloc_context3(codec));
        if (!encoder_) throw std::bad_alloc();
        encoder_->opaque = &log_;
        encoder_->width = options_.width / 2 * 2;
        encoder_->height = options_.height / 2 * 2;
        encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
        encoder_->colorspace = AVCOL_SPC_SMPTE170M;
        encoder_->color_range = AVCOL_RANGE_MPEG;
        encoder_->framerate = av_d2q(options_.fps, 100'000);
        encoder_->time_base = av_inv_q(encoder_->framerate);
        encoder_->gop_size = 25;
        encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
        if (codec->id == AV_CODEC_ID_H264) {
            av_opt_set(encoder_->priv_data, "preset", "veryfast", 0);
            av_opt_set_double(encoder_->priv_data, "crf", options_.quality, 0);
        } else {
            encoder_->flags |= AV_CODEC_FLAG_QSCALE;
            encoder_->global_quality = 4 * FF_QP2LAMBDA;
        }
        check(avcodec_open2(encoder_.get(), codec, nullptr));
    }

    void open_file() {
        AVFormatContext* context = nullptr;
        check(avformat_alloc_output_context2(&context, nullptr, muxer_of(file_.target()), nullptr));
        output_.reset(context);
        context->opaque = &log_;
        context->flags |= AVFMT_FLAG_BITEXACT;
        stream_ = avformat_new_stream(context, nullptr);
        if (stream_ == nullptr) throw std::bad_alloc();
        stream_->time_base = encoder_->time_base;
        stream_->avg_frame_rate = encoder_->framerate;
        check(avcodec_parameters_from_context(stream_->codecpar, encoder_.get()));
        check(avio_open(&context->pb, file_.temporary().c_str(), AVIO_FLAG_WRITE));
        check(avformat_write_header(context, nullptr));
    }

    // RGB to Y'CbCr of BT.601, limited range; chroma is the mean of 2 × 2 pixels.
    void fill(std::span<const std::uint8_t> rgb) {
        const int width = encoder_->width;
        const int height = encoder_->height;
        const auto at = [&](int x, int y) {
            return rgb.data() +
                   3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(options_.width) +
                        static_cast<std::size_t>(x));
        };
        const auto row = [&](int plane, int y) {
            return frame_->data[plane] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[plane];
        };
        for (int y = 0; y < height; ++y) {
            std::uint8_t* luma = row(0, y);
            for (int x = 0; x < width; ++x) {
                const std::uint8_t* p = at(x, y);
                luma[x] = level(16 + 0.256788 * p[0] + 0.504129 * p[1] + 0.097906 * p[2]);
            }
        }
        for (int y = 0; y < height; y += 2) {
            std::uint8_t* blue = row(1, y / 2);
            std::uint8_t* red = row(2, y / 2);
            for (int x = 0; x < width; x += 2) {
                double r = 0;
                double g = 0;
                double b = 0;
                for (const std::uint8_t* p :
                     {at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)}) {
                    r += 0.25 * p[0];
                    g += 0.25 * p[1];
                    b += 0.25 * p[2];
                }
                blue[x / 2] = level(128 - 0.148223 * r - 0.290993 * g + 0.439216 * b);
                red[x / 2] = level(128 + 0.439216 * r - 0.367788 * g - 0.071427 * b);
            }
        }
    }

    void drain() {
        for (;;) {
            const int code = avcodec_receive_packet(encoder_.get(), packet_.get());
            if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
            check(code);
            packet_->stream_index = stream_->index;
            packet_->duration = 1;
            av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
            check(av_interleaved_write_frame(output_.get(), packet_.get()));
        }
    }

    ColourVideoOptions options_;
    OutputFile file_;
    LibavLog log_;
    LibavPointer<AVCodecContext> encoder_;
    std::unique_ptr<AVFormatContext, OutputDeleter> output_;
    AVStream* stream_ = nullptr;  // owned by output_
    LibavPointer<AVPacket> packet_;
    LibavPointer<AVFrame> frame_;
    std::int64_t written_ = 0;
};

ColourVideo::ColourVideo(const fs::path& path, const ColourVideoOptions& options,
                         Overwrite overwrite) {
    if (muxer_of(path) == nullptr) {
        throw OptionError(
            {.problem = fmt::format("cannot tell what video '{}' is to be", path.string()),
             .actual = {},
             .expected = "a name that ends in .mp4, .mkv or .mov",
             .suggestion = {}});
    }
    if (options.width < 2 || options.height < 2 || !(options.fps > 0) ||
        !std::isfinite(options.fps)) {
        throw OptionError({.problem = "a video needs a size and a frame rate",
                           .actual = fmt::format("{} x {} px, {} frames a second", options.width,
                                                 options.height, options.fps),
                           .expected = "at least 2 x 2 px",
                           .suggestion = {}});
    }
    encoder_ = std::make_unique<Encoder>(path, options, overwrite);
}

ColourVideo::~ColourVideo() = default;

void ColourVideo::write(std::span<const std::uint8_t> rgb) {
    encoder_->write(rgb);
}

void ColourVideo::finish() {
    encoder_->finish();
}

bool is_colour_video_name(const fs::path& path) {
    return muxer_of(path) != nullptr;
}

}  // namespace grainfield::io
