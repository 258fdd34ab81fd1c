#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/snapshot.h"
#include "core/vec2.h"

namespace grainfield::testing {

/// A layer of spheres seen from above, with known truth. All lengths in pixels.
struct LayerScene {
    int width = 0;
    int height = 0;
    double diameter = 0;         ///< true diameter a
    std::vector<Vec2> position;  ///< liquid first, then the crystal
    std::vector<Layer> layer;    ///< checkerboard in the crystal, unknown in the liquid
    std::size_t crystal_begin = 0;
};

/// Discs on a square grid of the given spacing, each at a random sub-pixel offset.
LayerScene isolated_discs(int width, int height, double diameter, double spacing,
                          std::uint64_t seed);

/// A hard-disc liquid of the given area fraction (of discs of `diameter`), walls at the image
/// border, by Metropolis moves from a stretched triangular lattice.
LayerScene hard_disc_liquid(int width, int height, double diameter, double area_fraction,
                            std::uint64_t seed);

struct CrystalPatch {
    double radius = 0;       ///< of the patch, as a share of the width [-]
    double spacing = 0.81;   ///< projected lattice spacing s [a]
    double jitter = 0.03;    ///< Gaussian, per axis [a]
    double angle = 0.3;      ///< of the lattice [rad]
    double clearance = 0.9;  ///< least distance of liquid to crystal spheres [a]
};

/// A square bilayer patch in the middle of a liquid.
LayerScene crystal_in_liquid(int width, int height, double diameter, double area_fraction,
                             const CrystalPatch& patch, std::uint64_t seed);

/// Moves a scene by one frame: liquid spheres take Brownian steps that keep their distance, crystal
/// spheres jitter about their sites.
class LayerMotion {
 public:
    LayerMotion(const LayerScene& start, const CrystalPatch& patch, double liquid_step,
                std::uint64_t seed);
    const LayerScene& scene() const { return scene_; }
    void advance();

 private:
    LayerScene scene_;
    std::vector<Vec2> site_;
    double jitter_, step_;
    std::uint64_t seed_, frame_ = 0;
};

/// The image model of the tracker: tanh discs (apparent diameter D, edge width w)
/// sampled at pixel centres, product of transmissions, background 200, dark 30, Gaussian noise of
/// `noise` times the contrast, rounded to 8 bits.
Image tanh_frame(const LayerScene& scene, double apparent_diameter, double edge_width, double noise,
                 std::uint64_t seed);

/// Noise of RMS `sigma` counts about `mean`: white, or smoothed by a Gaussian of width `blur` [px];
/// 8 bits.
Image noise_frame(int width, int height, double mean, double sigma, double blur,
                  std::uint64_t seed);

/// A camera that knows nothing of tanh: area coverage of opaque discs with a reflecting rim,
/// Gaussian blur, uneven light, shot and read noise, saturation, rounding.
struct Camera {
    double apparent_diameter = 0.88;  ///< opaque disc [a]
    double rim_darkness = 0.6;        ///< of the mirror rim, r > a·0.88/(2√2) [-]
    double blur = 0.08;               ///< σ of the point spread [a]
    double vignetting = 0.15;         ///< loss of light in the corners [-]
    double electrons = 1e4;           ///< at full scale
    double read_noise = 10;           ///< [electrons]
    double exposure = 0.9;            ///< brightest background [full scale]
    int bit_depth = 8;
};
Image camera_frame(const LayerScene& scene, const Camera& camera, std::uint64_t seed);

}  // namespace grainfield::testing
