#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/padded_image.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/moment_sums.h"

namespace grainfield::tracking {

/// What a frame shows about one sphere, as vectors that turn with the picture.
///
/// Moments of order m on a ring of radius ρ are h_m = ⟨f(ρ, θ) e^{imθ}⟩. f is the residual of the
/// fit or the darkness. Terms are
///
///   Σ_j φ_k(d_j) û_j over neighbours, φ_k piecewise linear in their distance;
///   h_1 of each ring;
///   h_{m+1} h_m* of every two rings, m = 0 … 3.
///
/// A picture that is turned turns each of them, one that is mirrored mirrors them. So their factors
/// in a vector, such as the error of a position, are real.
class BiasTerms {
 public:
    /// `darkness`, `residual`: of the frame, of one size. `discs`: all that were fitted [px].
    /// `diameter`: true diameter a [px]. They outlive this.
    BiasTerms(const Image& darkness, const Image& residual, const std::vector<Vec2>& discs,
              double diameter);
    /// The same of a fit as it stands: its residual is darkness − 1 + transmission.
    BiasTerms(const PaddedImage& darkness, const PaddedImage& transmission,
              const std::vector<Vec2>& discs, double diameter);

    static constexpr int kDistances = 12;
    static constexpr int kRings = MomentSums::kRings;
    static constexpr int kSources = 2 * kRings;  ///< rings in the residual and in the darkness
    static constexpr int kOrders = 5;            ///< 0 … 4
    static constexpr int kCount =
        kDistances + kSources + (kOrders - 1) * kSources * kSources;  ///< terms
    /// Spheres farther from the border have all of them [a].
    static constexpr double kReach = 1.2;

    struct Terms {
        std::array<float, kCount> x, y;
    };
    /// Of a sphere at `place` [px], at least kReach from the border.
    Terms of(Vec2 place) const;
    /// Weights of the terms, in the order of of(), as weighted() reads them. kCount of them.
    class Weights {
     public:
        explicit Weights(const std::vector<double>& weights);

     private:
        friend class BiasTerms;
        /// Σ_k weight_k φ_k(d), piecewise linear: value and slope where d lies between two knots.
        struct Piece {
            double begin, value, slope;  ///< [a], [-], [1/a]
        };
        std::array<Piece, kDistances + 1> pieces_;
        MomentSums::Weights moments_;
    };
    struct Sum {
        Vec2 value;
        double nearest = 0;  ///< nearest()
    };
    /// Σ weight × term, without making the terms. Differs from the sum over of() by rounding.
    Sum weighted(Vec2 place, const Weights& weights) const;
    /// Distance of the nearest disc but for the one at `place` [a].
    double nearest(Vec2 place) const;

 private:
    std::array<Vec2, kDistances> neighbours(Vec2 place) const;
    MomentSums::Moments moments(Vec2 place) const;

    PixelRows darkness_, residual_;  ///< or the transmission
    bool is_transmission_;
    double diameter_;
    std::optional<PointGrid> grid_;  ///< none without discs
};

}  // namespace grainfield::tracking
