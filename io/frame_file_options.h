#pragma once

#include <cstdint>
#include <optional>

namespace grainfield::io {

struct FrameFileOptions {
    std::optional<double> fps;              ///< [1/s]; gives or overrides the frame rate
    std::int64_t max_pixels = 200'000'000;  ///< [px] larger frames are refused before allocating
    bool knows_filter = false;  ///< of a colour camera: a file that does not name it is no warning
};

}  // namespace grainfield::io
