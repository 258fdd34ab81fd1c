#include "pipelines/camera/camera_file.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_cameras(std::string_view bytes) {
    const Input input(bytes, ".toml");
    std::string text;
    if (!is_taken(input, [&] {
            text = pipelines::camera_file_text(pipelines::read_camera(input.path()));
        })) {
        return false;
    }
    const Input copy(text, ".copy.toml");
    promise(is_taken(copy,
                     [&] {
                         promise(pipelines::camera_file_text(pipelines::read_camera(copy.path())) ==
                                     text,
                                 "a camera that is written reads back the same");
                     }),
            "a camera that is written is one");
    return true;
}

}  // namespace grainfield::fuzz
