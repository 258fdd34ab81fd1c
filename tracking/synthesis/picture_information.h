#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/frame.h"
#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

/// How a picture is taken.
struct PictureSetting {
    int width = 0, height = 0;  ///< [px]
    double scale = 16;          ///< [px/a]
    double noise = 0.01;        ///< of a pixel, independent and Gaussian [radiance of the panel]
    double rays = 64;           ///< along a diameter at least; 4 a pixel and axis at most
    int threads = 1;
};

/// Spheres that move together. One coordinate q of the scene: sphere i is displaced by q ·
/// along[i].
struct SphereMotion {
    std::vector<std::int32_t> sphere;
    std::vector<Point3> along;
    double step = 0;  ///< half of what the derivative is a difference over [a]
    /// Standard error of q that is known without the picture [a].
    double known_to = std::numeric_limits<double>::infinity();
};

/// Motions of each of these spheres in x, y and z, in this order, over steps of kPlaneStep and
/// kHeightStep. Heights are known to be between the plates, `cell_height` apart [a].
std::vector<SphereMotion> motions_of(const std::vector<std::int32_t>& spheres, double cell_height);

constexpr double kPlaneStep = 1.0 / 32;   ///< [a] about those of SynthesisFit
constexpr double kHeightStep = 1.0 / 16;  ///< [a]

/// Standard deviation of a height that may be any between the plates [a].
double anywhere_between(double cell_height);

/// What one picture of mirror-like spheres tells of their coordinates: the Fisher information
///
///     A_kl = Σ_pixels ∂M/∂q_k ∂M/∂q_l / σ²  [1/a²]
///
/// M: the image of MirrorScene, whose optics are known, under even light. σ: noise of a pixel.
/// Bounds are those of (A + P)⁻¹. P is what is known without the picture, as if it were Gaussian:
/// 1/known_to² on the diagonal. Where the picture decides, this is the Cramér–Rao bound; where it
/// tells nothing, what was known. That spheres cannot overlap is not in P.
/// Derivatives are central differences of images of the same rays. Those of one sphere leave out
/// what is mirrored farther than 3 a away, those of several nothing. Valid where M is linear over
/// the error: bounds above about 0.1 a say only that the coordinate is badly told. Rays sample
/// edges: where an image hardly changes over the step, few rays decide, and the bound is too low.
/// Cost: two images of 3 a about it a motion, memory a picture a motion. Same bits for any number
/// of threads.
class PictureInformation {
 public:
    /// Throws std::invalid_argument for a motion without a step or of spheres that are not there.
    PictureInformation(std::vector<Point3> spheres, const MirrorOptics& optics,
                       const PictureSetting& setting, std::vector<SphereMotion> motions);

    std::size_t size() const { return motions_.size(); }
    double information(std::size_t k, std::size_t l) const { return matrix_[k * size() + l]; }

    /// The bound of these coordinates together, all others known; row by row [a²]. Throws
    /// std::domain_error if neither the picture nor anything else tells one of them.
    std::vector<double> covariance(const std::vector<std::size_t>& coordinates) const;

    /// A unit direction in these coordinates and the standard error along it, of the picture alone.
    struct Direction {
        double error = 0;  ///< [a]; infinite: no trace in the picture
        std::vector<double> along;
    };
    /// The one that the picture tells least.
    Direction weakest(const std::vector<std::size_t>& coordinates) const;

    /// Standard deviations of the noise by which the picture of other spheres differs,
    ///
    ///     √( min_q Σ_pixels (M_other − M − Σ_k q_k ∂M/∂q_k)² ) / σ,
    ///
    /// these coordinates being free to make up for what they can.
    double told_from(const std::vector<Point3>& other,
                     const std::vector<std::size_t>& coordinates) const;
    /// RMS of M_other − M over the pixels [radiance of the panel].
    double rms_from(const std::vector<Point3>& other) const;

 private:
    Image rendered(const std::vector<Point3>& spheres) const;

    std::vector<Point3> spheres_;
    MirrorOptics optics_;
    PictureSetting setting_;
    std::vector<SphereMotion> motions_;
    Image image_;
    std::vector<Image> derivative_;  ///< of each motion [1/a]
    std::vector<double> matrix_;
};

}  // namespace grainfield::tracking
