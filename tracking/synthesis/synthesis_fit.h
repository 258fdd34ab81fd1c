#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "tracking/synthesis/frame_light.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

/// Rays along a diameter while heights are chosen.
inline constexpr double kHeightRays = 12;

struct SynthesisLimits {
    double height = 1.94;       ///< of the cell [a]: centres lie within height − 1
    int most_rounds = 8;        ///< Gauss–Newton rounds
    double settled = 0.002;     ///< [a] rounds end where the RMS step in the plane is smaller
    double longest_step = 0.1;  ///< [a] in the plane, in one round
};

/// Positions and heights of all spheres of one frame, fitted to its image by Gauss–Newton on the
/// rendered image.
///
/// Minimises Σ (I − M(x, y, z))² + penalties over all spheres at once, M the image of MirrorScene
/// under the light of FrameLight. Penalties are the physics that the image may leave open: no two
/// centres nearer than a diameter, none outside the cell. Derivatives are differences of rendered
/// rays; those of a sphere are taken anew when it or a neighbour has moved by 0.03 a. Steps are
/// solved for together by Gauss–Seidel sweeps over the 3 × 3 blocks, and damped (Marquardt) while
/// the misfit rises.
class SynthesisFit {
 public:
    /// `brightness`: 0 in the core of a sphere, 1 on the panel, as a calibrated model says;
    /// `ceiling`: the same of the brightest count of the camera. Both outlive the fit. `rays`: see
    /// MirrorImage.
    SynthesisFit(const Image& brightness, const Image& ceiling, double scale, int threads,
                 double rays = kRaysPerDiameter);

    /// Begins with these spheres [a].
    void start(std::vector<Point3> spheres, const MirrorOptics& optics);
    /// The same where some of them (non-zero) stay where they are, and the light is known.
    void start(std::vector<Point3> spheres, const MirrorOptics& optics, std::vector<char> is_fixed,
               const FrameLight& light);

    /// Other spheres in place of some; optics and light stay what they are. Derivatives of those
    /// that stay, and whose neighbours do, are kept.
    void replace(std::vector<Point3> spheres);

    /// Rounds until nothing moves; how many.
    int refine(const SynthesisLimits& limits);
    /// Takes the heights that suit the image best one by one, all others where they are: moves each
    /// sphere by `share` of the way to the best of a few. How many moved.
    int choose_heights(const SynthesisLimits& limits, double share);
    /// Heights from none: each sphere to the best of a few, twice, then in turns with rounds of
    /// Gauss–Newton, the last of them a round. How many rounds. Meant for kHeightRays.
    int find_heights(SynthesisLimits limits);
    /// From here on residuals are those of an image of `rays` along a diameter; derivatives stay
    /// what they are.
    void sharpen(double rays);
    /// Optics (fitted_optics) and light that fit best where the spheres are now.
    void fit_optics();
    /// Light and residual anew, where the brightness that was given has changed.
    void relight();

    const std::vector<Point3>& spheres() const { return spheres_; }
    const MirrorOptics& optics() const { return optics_; }
    /// Of the last fit_optics(); zeros: none was made.
    const OpticsErrors& optics_error() const { return optics_error_; }
    const FrameLight& light() const { return light_; }
    double scale() const { return scale_; }  ///< [px/a]
    double rms() const { return rms_; }      ///< of image − rendering [contrast]
    /// Σ (image − rendering)² but for the border that the blur reaches [contrast²].
    double misfit() const;
    /// Σ (image − rendering)² within 0.6 a of a sphere, where the frame shows it [contrast²].
    struct LocalMisfit {
        double sum = 0;
        int pixels = 0;
    };
    LocalMisfit misfit_about(std::size_t sphere) const;
    /// By how much spheres overlap in space, Σ (1 − distance)² over all pairs [a²].
    double overlap() const;
    const Image& residual() const { return residual_; }
    /// Radiance where the spheres are now, before the light.
    const Image& rendering() const { return fine_ ? fine_->image() : image_.image(); }

    /// 3 × 3 blocks of the joint information matrix, penalties included [1/a²].
    struct Block {
        std::int32_t other;
        std::array<float, 9> value;
    };
    struct Information {
        std::vector<std::array<double, 9>> own;
        std::vector<std::vector<Block>> pair;
        std::vector<std::array<double, 3>> gradient;
    };
    enum class Contacts { penalised, ignored };
    /// Where the spheres are now. Ignored, contacts leave the image to speak alone.
    Information information(Contacts contacts = Contacts::penalised);
    /// The spheres near one of them.
    const NearSpheres& near(std::size_t sphere) const {
        return scene_.front().near(static_cast<std::int32_t>(sphere));
    }
    /// Its gradient if this were image − rendering, without that of the penalties. After
    /// information().
    std::vector<std::array<double, 3>> gradient_of(const Image& residual) const;

 private:
    void render();
    bool is_fixed(std::size_t i) const { return !is_fixed_.empty() && is_fixed_[i] != 0; }
    void take_derivatives();
    float best_height(std::size_t sphere, float top) const;
    Information normal_equations(Contacts contacts) const;
    std::vector<std::array<double, 3>> solve(const Information& info, double damping) const;

    const Image& brightness_;
    const Image& ceiling_;
    double scale_;
    int threads_;
    std::vector<Point3> spheres_;
    MirrorOptics optics_;
    OpticsErrors optics_error_;
    MirrorImage image_;
    std::optional<MirrorImage> fine_;  ///< the image that is compared with, if another
    std::vector<MirrorScene> scene_;   ///< one or none
    std::vector<char> is_fixed_;       ///< empty: none
    bool is_light_known_ = false;
    FrameLight light_;
    Image residual_;
    double rms_ = 0;
    std::vector<std::array<ImagePatch, 3>> derivative_;
    std::vector<float> moved_;  ///< path since the derivatives were taken [a]
};

}  // namespace grainfield::tracking
