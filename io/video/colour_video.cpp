#include "io/video/colour_video.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

extern "C" {
#include <libavutil/opt.h>
}

#include "core/errors.h"
#include "io/video/detail/video_encoder.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

const char* muxer_of(const fs::path& path) {
    const std::string extension = path.extension().string();
    if (extension == ".mp4") return "mp4";
    if (extension == ".mov") return "mov";
    return extension == ".mkv" ? "matroska" : nullptr;
}

std::uint8_t level(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

VideoEncoder::Format for_people(const fs::path& path, const ColourVideoOptions& options) {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (codec == nullptr) codec = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
    const auto configure = [codec, &options](AVCodecContext& encoder) {
        encoder.width = options.width / 2 * 2;
        encoder.height = options.height / 2 * 2;
        encoder.pix_fmt = AV_PIX_FMT_YUV420P;
        encoder.colorspace = AVCOL_SPC_SMPTE170M;
        encoder.color_range = AVCOL_RANGE_MPEG;
        encoder.framerate = av_d2q(options.fps, 100'000);
        encoder.gop_size = 25;
        encoder.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
        if (codec->id == AV_CODEC_ID_H264) {
            av_opt_set(encoder.priv_data, "preset", "veryfast", 0);
            av_opt_set_double(encoder.priv_data, "crf", options.quality, 0);
        } else {
            encoder.flags |= AV_CODEC_FLAG_QSCALE;
            encoder.global_quality = 4 * FF_QP2LAMBDA;
        }
    };
    return {.codec = codec,
            .codec_name = "H.264 or MPEG-4",
            .muxer = muxer_of(path),
            .configure = configure};
}

/// One picture of this stream is a JPEG file.
VideoEncoder::Format one_jpeg(const ColourVideoOptions& options) {
    const auto configure = [&options](AVCodecContext& encoder) {
        encoder.width = options.width / 2 * 2;
        encoder.height = options.height / 2 * 2;
        encoder.pix_fmt = AV_PIX_FMT_YUVJ420P;
        encoder.color_range = AVCOL_RANGE_JPEG;
        encoder.framerate = {25, 1};
        encoder.flags |= AV_CODEC_FLAG_QSCALE;
        encoder.global_quality = 3 * FF_QP2LAMBDA;
    };
    return {.codec = avcodec_find_encoder(AV_CODEC_ID_MJPEG),
            .codec_name = "JPEG",
            .muxer = "mjpeg",
            .configure = configure};
}

}  // namespace

class ColourVideo::Encoder {
 public:
    Encoder(const fs::path& path, const ColourVideoOptions& options, Overwrite overwrite,
            const VideoEncoder::Format& format)
        : options_(options), encoder_(path, overwrite, format) {}

    void write(std::span<const std::uint8_t> rgb) {
        const auto expected = static_cast<std::size_t>(options_.width) *
                              static_cast<std::size_t>(options_.height) * 3;
        if (rgb.size() != expected) {
            throw OptionError({.problem = "a picture of the video has another size",
                               .actual = fmt::format("{} bytes", rgb.size()),
                               .expected = fmt::format("{}, as announced", expected),
                               .suggestion = {}});
        }
        fill(encoder_.picture(), rgb);
        encoder_.send();
    }

    void finish() { encoder_.finish(); }

 private:
    // RGB to Y'CbCr of BT.601, of films in limited range; chroma is the mean of 2 × 2 pixels.
    void fill(AVFrame& picture, std::span<const std::uint8_t> rgb) const {
        const bool is_full = picture.format == AV_PIX_FMT_YUVJ420P;
        const double black = is_full ? 0 : 16;
        const double luma_range = is_full ? 1 : 219.0 / 255;
        const double chroma_range = is_full ? 1 : 224.0 / 255;
        const int width = picture.width;
        const int height = picture.height;
        const auto at = [&](int x, int y) {
            return rgb.data() +
                   3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(options_.width) +
                        static_cast<std::size_t>(x));
        };
        const auto row = [&](int plane, int y) {
            return picture.data[plane] + static_cast<std::ptrdiff_t>(y) * picture.linesize[plane];
        };
        for (int y = 0; y < height; ++y) {
            std::uint8_t* luma = row(0, y);
            for (int x = 0; x < width; ++x) {
                const std::uint8_t* p = at(x, y);
                luma[x] = level(black + luma_range * (0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]));
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
                blue[x / 2] = level(128 + chroma_range * (-0.168736 * r - 0.331264 * g + 0.5 * b));
                red[x / 2] = level(128 + chroma_range * (0.5 * r - 0.418688 * g - 0.081312 * b));
            }
        }
    }

    ColourVideoOptions options_;
    VideoEncoder encoder_;
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
    encoder_ = std::make_unique<Encoder>(path, options, overwrite, for_people(path, options));
}

ColourVideo::~ColourVideo() = default;

void ColourVideo::write(std::span<const std::uint8_t> rgb) {
    encoder_->write(rgb);
}

void ColourVideo::finish() {
    encoder_->finish();
}

void write_jpeg(const fs::path& path, std::span<const std::uint8_t> rgb, int width, int height,
                Overwrite overwrite) {
    const ColourVideoOptions options{.width = width, .height = height};
    ColourVideo::Encoder encoder(path, options, overwrite, one_jpeg(options));
    encoder.write(rgb);
    encoder.finish();
}

bool is_colour_video_name(const fs::path& path) {
    return muxer_of(path) != nullptr;
}

}  // namespace grainfield::io
