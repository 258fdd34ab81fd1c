#include "io/frame_files.h"
#include "tests/fuzz/frames.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_images(std::string_view bytes) {
    // The others go to the reader of videos.
    const std::string_view head = bytes.substr(0, io::bytes_to_recognise);
    if (io::find_image_format(head, io::image_formats()) == nullptr) return false;
    const Input input(bytes, ".image");
    return is_taken(input, [&] {
        const auto frames =
            io::open_frames({input.path()}, {.fps = std::nullopt, .max_pixels = 1 << 18});
        read_some(*frames);
    });
}

}  // namespace grainfield::fuzz
