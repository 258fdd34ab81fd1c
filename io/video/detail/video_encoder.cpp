#include "io/video/detail/video_encoder.h"

#include <new>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

namespace {

[[noreturn]] void fail(const OutputFile& file, const std::string& reason) {
    throw OutputError({.problem = fmt::format("cannot write '{}'", file.target().string()),
                       .actual = reason,
                       .expected = {},
                       .suggestion = "check the free space and quota of that disk"});
}

}  // namespace

void VideoEncoder::OutputDeleter::operator()(AVFormatContext* context) const {
    avio_closep(&context->pb);
    avformat_free_context(context);
}

VideoEncoder::VideoEncoder(const std::filesystem::path& path, Overwrite overwrite,
                           const Format& format)
    : file_(path, overwrite) {
    if (format.codec == nullptr) {
        fail(file_, fmt::format("libavcodec has no encoder for {}", format.codec_name));
    }
    open_encoder(format);
    open_file(format.muxer);
    packet_.reset(av_packet_alloc());
    frame_.reset(av_frame_alloc());
    if (!packet_ || !frame_) throw std::bad_alloc();
    frame_->format = encoder_->pix_fmt;
    frame_->width = encoder_->width;
    frame_->height = encoder_->height;
    check(av_frame_get_buffer(frame_.get(), 0));
}

AVFrame& VideoEncoder::picture() {
    check(av_frame_make_writable(frame_.get()));
    return *frame_;
}

void VideoEncoder::send() {
    frame_->pts = written_++;
    check(avcodec_send_frame(encoder_.get(), frame_.get()));
    drain();
}

void VideoEncoder::finish() {
    check(avcodec_send_frame(encoder_.get(), nullptr));
    drain();
    check(av_write_trailer(output_.get()));
    avio_flush(output_->pb);
    if (output_->pb->error < 0) check(output_->pb->error);
    output_.reset();
    file_.commit();
}

void VideoEncoder::check(int code) const {
    if (code < 0) fail(file_, libav_error(code));
}

void VideoEncoder::open_encoder(const Format& format) {
    encoder_.reset(avcodec_alloc_context3(format.codec));
    if (!encoder_) throw std::bad_alloc();
    encoder_->opaque = &log_;
    format.configure(*encoder_);
    encoder_->time_base = av_inv_q(encoder_->framerate);
    check(avcodec_open2(encoder_.get(), format.codec, nullptr));
}

void VideoEncoder::open_file(const char* muxer) {
    AVFormatContext* context = nullptr;
    check(avformat_alloc_output_context2(&context, nullptr, muxer, nullptr));
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

void VideoEncoder::drain() {
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

}  // namespace grainfield::io
