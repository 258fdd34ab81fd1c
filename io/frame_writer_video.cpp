#include "io/frame_writer_video.h"

#include <cmath>
#include <cstring>
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

AVPixelFormat pixel_format(int bit_depth) {
    if (bit_depth <= 8) return AV_PIX_FMT_GRAY8;
    if (bit_depth <= 10) return AV_PIX_FMT_GRAY10LE;
    return bit_depth <= 12 ? AV_PIX_FMT_GRAY12LE : AV_PIX_FMT_GRAY16LE;
}

class VideoWriter : public FrameWriter {
 public:
    VideoWriter(const fs::path& path, const FrameWriterOptions& options, Overwrite overwrite)
        : options_(options), file_(path, overwrite) {
        const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_FFV1);
        if (codec == nullptr) fail("libavcodec has no FFV1 encoder");
        open_encoder(codec);
        open_file();
        packet_.reset(av_packet_alloc());
        frame_.reset(av_frame_alloc());
        if (!packet_ || !frame_) throw std::bad_alloc();
        frame_->format = encoder_->pix_fmt;
        frame_->width = options_.width;
        frame_->height = options_.height;
        check(av_frame_get_buffer(frame_.get(), 0));
    }

    void write(const Frame& frame) override {
        const std::vector<std::uint8_t> bytes = counts_of(frame, options_);
        check(av_frame_make_writable(frame_.get()));
        const std::size_t row = bytes.size() / static_cast<std::size_t>(options_.height);
        for (int y = 0; y < options_.height; ++y) {
            std::memcpy(frame_->data[0] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[0],
                        bytes.data() + static_cast<std::size_t>(y) * row, row);
        }
        frame_->pts = written_++;
        check(avcodec_send_frame(encoder_.get(), frame_.get()));
        drain();
    }

    void finish() override {
        check(avcodec_send_frame(encoder_.get(), nullptr));
        drain();
        check(av_write_trailer(output_.get()));
        avio_flush(output_->pb);
        if (output_->pb->error < 0) check(output_->pb->error);
        output_.reset();
        file_.commit();
    }

    std::vector<fs::path> outputs() const override { return {file_.target()}; }

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

    void open_encoder(const AVCodec* codec) {
        encoder_.reset(avcodec_alloc_context3(codec));
        if (!encoder_) throw std::bad_alloc();
        encoder_->opaque = &log_;
        encoder_->width = options_.width;
        encoder_->height = options_.height;
        encoder_->pix_fmt = pixel_format(options_.bit_depth);
        encoder_->framerate = av_d2q(*options_.fps, 1'000'000);
        encoder_->time_base = av_inv_q(encoder_->framerate);
        encoder_->level = 3;
        encoder_->gop_size = 1;  // every frame can be read alone
        // The number of slices is part of the bytes; that of threads is not.
        encoder_->slices = 4;
        encoder_->thread_type = FF_THREAD_SLICE;
        encoder_->flags |= AV_CODEC_FLAG_BITEXACT;
        av_opt_set(encoder_->priv_data, "slicecrc", "1", 0);
        check(avcodec_open2(encoder_.get(), codec, nullptr));
    }

    void open_file() {
        const bool matroska = file_.target().extension() == ".mkv";
        AVFormatContext* context = nullptr;
        check(avformat_alloc_output_context2(&context, nullptr, matroska ? "matroska" : "avi",
                                             nullptr));
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

    FrameWriterOptions options_;
    OutputFile file_;
    LibavLog log_;
    LibavPointer<AVCodecContext> encoder_;
    std::unique_ptr<AVFormatContext, OutputDeleter> output_;
    AVStream* stream_ = nullptr;  // owned by output_
    LibavPointer<AVPacket> packet_;
    LibavPointer<AVFrame> frame_;
    std::int64_t written_ = 0;
};

}  // namespace

std::unique_ptr<FrameWriter> make_video_writer(const fs::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite) {
    if (!options.fps || !(*options.fps > 0) || !std::isfinite(*options.fps)) {
        throw OptionError({.problem = fmt::format("'{}' needs a frame rate", path.string()),
                           .actual = "none is known",
                           .expected = {},
                           .suggestion = "give --frame-rate, or write pictures into a folder"});
    }
    return std::make_unique<VideoWriter>(path, options, overwrite);
}

}  // namespace grainfield::io
