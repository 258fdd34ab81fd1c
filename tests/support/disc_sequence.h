#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/support/image_files.h"
#include "tests/support/layer_frames.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::testing {

/// What the small pictures below show [px].
inline constexpr double kApparentDiameter = 9;
inline constexpr double kEdgeWidth = 1.25;
inline constexpr int kPictureSize = 192;

/// Well separated discs on a 16 px grid.
inline LayerScene few_discs() {
    return isolated_discs(kPictureSize, kPictureSize, 10, 16, 1);
}

/// Frame `index` of a film in which all discs drift by (0.3, −0.2) px a frame.
inline Image disc_frame(const LayerScene& start, int index) {
    LayerScene moved = start;
    for (Vec2& p : moved.position) p += Vec2{0.3, -0.2} * index;
    return tanh_frame(moved, kApparentDiameter, kEdgeWidth, 0.02,
                      static_cast<std::uint64_t>(index));
}

/// Writes frame_000.png … into the folder and returns their paths.
inline std::vector<std::string> write_disc_sequence(const ScratchFolder& folder, int frames) {
    const LayerScene start = few_discs();
    std::vector<std::string> paths;
    for (int i = 0; i < frames; ++i) {
        paths.push_back(folder / fmt::format("frame_{:03}.png", i));
        write_png(paths.back(), disc_frame(start, i));
    }
    return paths;
}

}  // namespace grainfield::testing
