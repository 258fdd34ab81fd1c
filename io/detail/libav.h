#pragma once

#include <memory>
#include <mutex>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "core/frame.h"
#include "io/images/picture.h"

namespace grainfield::io {

struct LibavDeleter {
    void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
    void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
    void operator()(AVFrame* p) const { av_frame_free(&p); }
    void operator()(AVPacket* p) const { av_packet_free(&p); }
};
template <class T>
using LibavPointer = std::unique_ptr<T, LibavDeleter>;

/// Collects the errors that libav logs for the contexts whose `opaque` points here, from any of its
/// threads. Nothing that libav logs is printed.
class LibavLog {
 public:
    LibavLog();
    void add(const char* text);
    /// What was logged since the last call, in one line.
    std::string take();

 private:
    std::mutex mutex_;
    std::string text_;
};

/// "Invalid data found when processing input"
std::string libav_error(int code);

/// `code` as libav returned it. Throws std::bad_alloc where memory ran out, that is where 256 MB
/// are not to be had: no frame is damaged by that. Where they are, the file declares an absurd
/// size.
int unless_out_of_memory(int code);

/// A decoder for `parameters` that refuses pictures above `max_pixels`, checks what checksums there
/// are, and decodes slices of one picture in parallel. Not frames in parallel: what is logged
/// while a packet is decoded then belongs to that packet, for any number of threads. Throws Error.
LibavPointer<AVCodecContext> open_decoder(const AVCodecParameters& parameters, LibavLog& log,
                                          std::int64_t max_pixels);

/// Reduces a decoded picture to grey counts: the first plane of grey and YUV, the luma of RGB and
/// palettes. Throws InputError for formats of more than 16 bit or floating point.
Picture to_grey(const std::filesystem::path& path, const AVFrame& frame);

}  // namespace grainfield::io
