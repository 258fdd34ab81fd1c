#pragma once

#include <algorithm>

#include "core/frame.h"

namespace grainfield {

/// The width × height pixels of `image` that begin at (x, y), all inside it.
inline Image part_of(const Image& image, int x, int y, int width, int height) {
    Image part(width, height);
    for (int row = 0; row < height; ++row) {
        std::copy_n(image.row(y + row) + x, width, part.row(row));
    }
    return part;
}

}  // namespace grainfield
