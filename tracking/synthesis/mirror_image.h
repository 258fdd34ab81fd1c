#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "tracking/synthesis/mirror_scene.h"

namespace grainfield::tracking {

/// A rectangle of an image, and by how much its pixels change.
struct ImagePatch {
    int x = 0, y = 0;  ///< its first pixel
    int width = 0, height = 0;
    std::vector<float> value;

    const float* row(int v) const {
        return value.data() + static_cast<std::ptrdiff_t>(v) * static_cast<std::ptrdiff_t>(width);
    }
};

constexpr double kRaysPerDiameter = 28;

/// The image of mirror-like spheres, with what is needed to tell how it changes when one moves.
///
/// Each pixel is the mean of samples() × samples() rays on a regular grid, the same in every image
/// (common random numbers), then blurred. Each sphere knows the rays that it touches: only these
/// are followed again when it moves. Memory: 12 bytes a ray and 4 for each sphere that it touches,
/// 250 MB at 1600² pixels and 2 × 2 rays. Same bits for any number of threads.
class MirrorImage {
 public:
    /// `scale`: pixels a diameter. `rays`: wanted along a diameter.
    MirrorImage(int width, int height, double scale, int threads, double rays = kRaysPerDiameter);

    /// The rays a pixel and axis: as many as make `rays` to a diameter, 1 to 4.
    int samples() const { return samples_; }
    double scale() const { return scale_; }

    /// Positions are in diameters; pixel (column, row) is centred on (column, row)/scale.
    void render(const MirrorScene& scene);
    /// The same image to rounding; derivatives and changes stay those of the one rendered before.
    void render_only(const MirrorScene& scene);
    /// Radiance [panel], blurred.
    const Image& image() const { return image_; }
    /// Images under several optics (at most MirrorScene::kMostOptics) with the camera of the scene;
    /// each ray is followed once. What was rendered before stays. Throws std::length_error for
    /// more.
    std::vector<Image> renderings(const MirrorScene& scene,
                                  const std::vector<MirrorOptics>& optics) const;

    /// ∂(image)/∂q where sphere i moves along `direction`, from a difference over that step [1/a].
    ImagePatch derivative(const MirrorScene& scene, std::int32_t sphere, Point3 step) const;

    /// Image with a sphere at `to` − image, by the rays within `radius` of it [a].
    ImagePatch change(const MirrorScene& scene, std::int32_t sphere, Point3 to,
                      double radius) const;

    /// `image` convolved with the Gaussian of these optics, zero outside.
    void blur(ImagePatch& patch, double sigma) const;

 private:
    struct Touch {
        std::int32_t sphere;
        std::int32_t ray;
    };
    Point3 place(std::int32_t ray) const;
    /// Of the rays of a row [a].
    std::vector<float> places() const;
    ImagePatch empty_patch(Point3 centre, int half) const;

    int width_, height_;
    double scale_;
    int threads_;
    int samples_;
    Image image_;
    std::vector<float> value_;         ///< of each ray, row by row
    std::vector<std::int32_t> first_;  ///< sphere that it meets; −1: none
    std::vector<std::int64_t> begin_;  ///< of the rays that touch each sphere
    std::vector<std::int32_t> ray_;
};

/// Separable Gaussian with borders repeated.
Image gaussian_blurred(const Image& image, double sigma, int threads);

}  // namespace grainfield::tracking
