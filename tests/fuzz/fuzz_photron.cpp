#include <algorithm>

#include "io/frame_files.h"
#include "tests/fuzz/frames.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_photron(std::string_view bytes) {
    if (bytes.size() < 2) return false;
    // Two bytes: length of the header; then the header, then the pixels.
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
    const std::size_t length = std::min<std::size_t>(byte(0) + 256U * byte(1), bytes.size() - 2);
    const std::string_view text = bytes.substr(2, length);
    const Input header(text, text.starts_with('#') ? ".cih" : ".cihx");
    const Input pixels(bytes.substr(2 + length), ".mraw");
    return is_taken(header.path().stem().string(), [&] {
        const auto frames =
            io::open_frames({header.path()}, {.fps = std::nullopt, .max_pixels = 1 << 18});
        read_some(*frames);
    });
}

}  // namespace grainfield::fuzz
