#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "core/support/output_file.h"
#include "io/detail/libav.h"

namespace grainfield::io {

/// One encoded stream into a file that appears under its name when it is complete.
class VideoEncoder {
 public:
    struct Format {
        const AVCodec* codec = nullptr;                  ///< nullptr: the encoder is missing
        const char* codec_name = "";                     ///< for the error that says so
        const char* muxer = "";                          ///< of libavformat
        std::function<void(AVCodecContext&)> configure;  ///< size, pixels, rate, quality
    };

    /// Throws OutputError as OutputFile does, if the encoder is missing or refuses the format.
    VideoEncoder(const std::filesystem::path& path, Overwrite overwrite, const Format& format);

    /// The picture to fill for the next send(); its rows are those of the configured format.
    AVFrame& picture();
    /// Encodes and writes the picture. Throws OutputError.
    void send();
    /// Completes the file. Throws OutputError.
    void finish();

    const std::filesystem::path& target() const { return file_.target(); }

 private:
    // The context that writes, unlike LibavDeleter's, which reads.
    struct OutputDeleter {
        void operator()(AVFormatContext* context) const;
    };

    void check(int code) const;
    void open_encoder(const Format& format);
    void open_file(const char* muxer);
    void drain();

    OutputFile file_;
    LibavLog log_;
    LibavPointer<AVCodecContext> encoder_;
    std::unique_ptr<AVFormatContext, OutputDeleter> output_;
    AVStream* stream_ = nullptr;  // owned by output_
    LibavPointer<AVPacket> packet_;
    LibavPointer<AVFrame> frame_;
    std::int64_t written_ = 0;
};

}  // namespace grainfield::io
