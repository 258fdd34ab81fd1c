#include "io/video/video_frames.h"
#include "tests/fuzz/frames.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_videos(std::string_view bytes) {
    const Input input(bytes, ".avi");
    return is_taken(input, [&] {
        const auto frames =
            io::open_video(input.path(), {.fps = std::nullopt, .max_pixels = 1 << 18});
        read_some(*frames);
    });
}

}  // namespace grainfield::fuzz
