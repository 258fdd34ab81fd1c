#include "pipelines/track/calibration_file.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_calibrations(std::string_view bytes) {
    const Input input(bytes, ".toml");
    std::string text;
    if (!is_taken(input,
                  [&] { text = pipelines::text_of(pipelines::read_calibration(input.path())); })) {
        return false;
    }
    const Input copy(text, ".copy.toml");
    promise(is_taken(copy,
                     [&] {
                         promise(
                             pipelines::text_of(pipelines::read_calibration(copy.path())) == text,
                             "a calibration that is written reads back the same");
                     }),
            "a calibration that is written is one");
    return true;
}

}  // namespace grainfield::fuzz
