#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tests/support/slit_spheres.h"

namespace grainfield::testing {

/// S(k) = S0 + S1 (ka)^α up to `peak`, from there a straight line down to `beyond` at `cut`.
struct WantedSpectrum {
    double s0 = 0;
    double s1 = 2;
    double alpha = 1;
    double peak = 0.25;    ///< where S is largest [1/a]
    double cut = 0.4;      ///< waves below this are set [1/a]
    double beyond = 0.12;  ///< S at the cut; the liquid of hard spheres has .05 there [-]

    double at(double k) const;
};

struct KnownSpectrumOptions {
    double side = 100;        ///< of the square floor [a]
    double height = 1.94;     ///< distance of the plates [a]
    double spacing = 0.9243;  ///< of the sites from which the liquid is shaken [a]: φ = .919
    double margin =
        0;  ///< of the cosine modes from the walls [a]: 0 box, 0.5 what centres can reach
    WantedSpectrum wanted;
    double diffusion = 0;      ///< D: modes keep exp(−D k²) of themselves to the next frame;
                               ///< 0: nothing, frames are independent [a² a frame]
    double tolerance = 1e-10;  ///< of a mode, in units of sqrt(grains)
    int liquids = 8;           ///< shaken in turn; each is turned and mirrored at random
    int melt = 60;             ///< sweeps before the first frame
    std::uint64_t seed = 1;
};

/// Layers of spheres between walls whose S(k) is known at long waves because it is put in.
///
/// A frame begins as a liquid of hard spheres in the slit (Metropolis moves). Its cosine modes
///
///   c_nm = Σ_j cos(k_n x_j) cos(k_m y_j),  k_n = π n/L,  0 < |k| < cut,
///
/// are replaced by Gaussian numbers of variance N S(k)/4 (N S(k)/2 for n = 0 or m = 0), so that
/// their squares are distributed as those of a real layer. Each sphere is moved by the gradient
/// Σ a_nm ∇(cos cos), which has no part normal to a wall. The a_nm are found by repeated
/// correction, a += N⁻¹ 4/k² (c − wanted), until every mode is the wanted one to `tolerance`.
///
/// Spheres that touched overlap by some percent afterwards: silhouettes do not see it.
class KnownSpectrumLayer {
 public:
    explicit KnownSpectrumLayer(const KnownSpectrumOptions& options);

    std::size_t grains() const { return grains_; }
    /// The next frame. Throws std::runtime_error if the modes do not converge.
    SlitScene next();
    /// (n, m), the wavevector and the amplitude that the last frame was given.
    struct Wave {
        int n = 0, m = 0;
        double k = 0;       ///< [1/a]
        double width = 0;   ///< standard deviation of c
        double wanted = 0;  ///< c of the last frame
    };
    const std::vector<Wave>& waves() const { return waves_; }
    /// The amplitudes c of a scene, in the order of `waves`.
    std::vector<double> amplitudes(const std::vector<Vec2>& position) const;

 private:
    KnownSpectrumOptions options_;
    std::size_t grains_ = 0;
    int largest_ = 0;  ///< n and m
    double step_ = 0;  ///< of wavevectors [1/a]
    std::vector<Wave> waves_;
    std::vector<SlitScene> liquids_;
    std::int64_t frame_ = 0;
};

}  // namespace grainfield::testing
