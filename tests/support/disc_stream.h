#pragma once

#include <string>

#include "tests/support/disc_sequence.h"
#include "tests/support/fifo.h"

namespace grainfield::testing {

/// The counts of a frame of the film of `disc_frame`, a byte each.
inline std::string raw_disc_frame(int index) {
    const auto bytes = bytes_of(disc_frame(few_discs(), index));
    return {bytes.begin(), bytes.end()};
}

/// Begins a stream of such frames; `space` as in YUV4MPEG.
inline std::string disc_stream_header(const std::string& space = "mono") {
    return yuv4mpeg_header(kPictureSize, kPictureSize, space);
}

/// One of its frames.
inline std::string disc_stream_frame(int index) {
    return "FRAME\n" + raw_disc_frame(index);
}

/// Header and the first frames, as long as they are read; the FIFO stays open.
inline void write_disc_stream(Fifo& fifo, int frames) {
    bool is_read = fifo.write(disc_stream_header());
    for (int i = 0; i < frames && is_read; ++i) is_read = fifo.write(disc_stream_frame(i));
}

}  // namespace grainfield::testing
