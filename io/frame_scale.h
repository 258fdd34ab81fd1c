#pragma once

#include <optional>

namespace grainfield::io {

/// A frame source whose file says how large a pixel is.
class FrameScale {
 public:
    virtual ~FrameScale() = default;
    /// Side of a pixel in the scene [mm]; empty: not known.
    virtual std::optional<double> pixel_mm() const = 0;
};

}  // namespace grainfield::io
