#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace grainfield {

/// A grey image in single precision, row-major, row 0 on top.
///
/// The centre of pixel (column, row) is the point (column, row); x grows to the right and y grows
/// downwards (docs/conventions.md).
class Image {
 public:
    Image() = default;
    Image(int width, int height, float value = 0)
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}

    int width() const { return width_; }
    int height() const { return height_; }
    std::size_t size() const { return pixels_.size(); }
    bool empty() const { return pixels_.empty(); }

    float& operator()(int x, int y) { return pixels_[offset(x, y)]; }
    float operator()(int x, int y) const { return pixels_[offset(x, y)]; }
    float* row(int y) { return pixels_.data() + offset(0, y); }
    const float* row(int y) const { return pixels_.data() + offset(0, y); }
    std::vector<float>& pixels() { return pixels_; }
    const std::vector<float>& pixels() const { return pixels_; }

    friend bool operator==(const Image&, const Image&) = default;

 private:
    std::size_t offset(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_ = 0;
    int height_ = 0;
    std::vector<float> pixels_;
};

enum class FrameStatus { ok, corrupt, missing };

/// One camera frame. `image` holds the camera's counts as they are in the file (0 … 2^bit_depth −
/// 1), colour reduced to luma; it is empty unless the status is ok.
struct Frame {
    Image image;
    std::int64_t index = 0;  ///< position in the source, from 0; gaps keep their index
    double time = 0;         ///< [s] if the source knows its frame rate, else equal to index
    int bit_depth = 8;       ///< of the source, 1–16
    FrameStatus status = FrameStatus::ok;
    std::string message;  ///< why the frame is corrupt or missing
};

}  // namespace grainfield
