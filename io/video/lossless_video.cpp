#include "io/video/lossless_video.h"

#include <cmath>
#include <cstring>
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

AVPixelFormat pixel_format(int bit_depth) {
    if (bit_depth <= 8) return AV_PIX_FMT_GRAY8;
    if (bit_depth <= 10) return AV_PIX_FMT_GRAY10LE;
    return bit_depth <= 12 ? AV_PIX_FMT_GRAY12LE : AV_PIX_FMT_GRAY16LE;
}

VideoEncoder::Format lossless(const fs::path& path, const FrameWriterOptions& options) {
    const auto configure = [&options](AVCodecContext& encoder) {
        encoder.width = options.width;
        encoder.height = options.height;
        encoder.pix_fmt = pixel_format(options.bit_depth);
        encoder.framerate = av_d2q(*options.fps, 1'000'000);
        encoder.level = 3;
        encoder.gop_size = 1;  // every frame can be read alone
        // The number of slices is part of the bytes; that of threads is not.
        encoder.slices = 4;
        encoder.thread_type = FF_THREAD_SLICE;
        encoder.flags |= AV_CODEC_FLAG_BITEXACT;
        av_opt_set(encoder.priv_data, "slicecrc", "1", 0);
    };
    return {.codec = avcodec_find_encoder(AV_CODEC_ID_FFV1),
            .codec_name = "FFV1",
            .muxer = path.extension() == ".mkv" ? "matroska" : "avi",
            .configure = configure};
}

class VideoWriter : public FrameWriter {
 public:
    VideoWriter(const fs::path& path, const FrameWriterOptions& options, Overwrite overwrite)
        : options_(options), encoder_(path, overwrite, lossless(path, options_)) {}

    void write(const Frame& frame) override {
        const std::vector<std::uint8_t> bytes = counts_of(frame, options_);
        AVFrame& picture = encoder_.picture();
        const std::size_t row = bytes.size() / static_cast<std::size_t>(options_.height);
        for (int y = 0; y < options_.height; ++y) {
            std::memcpy(picture.data[0] + static_cast<std::ptrdiff_t>(y) * picture.linesize[0],
                        bytes.data() + static_cast<std::size_t>(y) * row, row);
        }
        encoder_.send();
    }

    void finish() override { encoder_.finish(); }
    bool holds(std::int64_t) const override { return false; }

    std::vector<fs::path> outputs() const override { return {encoder_.target()}; }

 private:
    FrameWriterOptions options_;
    VideoEncoder encoder_;
};

}  // namespace

std::unique_ptr<FrameWriter> make_video_writer(const fs::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite) {
    if (!options.fps || !(*options.fps > 0) || !std::isfinite(*options.fps)) {
        throw OptionError({.problem = fmt::format("'{}' needs a frame rate", path.string()),
                           .actual = "none is known",
                           .expected = {},
                           .suggestion = "give a frame rate, or write pictures into a folder"});
    }
    return std::make_unique<VideoWriter>(path, options, overwrite);
}

}  // namespace grainfield::io
