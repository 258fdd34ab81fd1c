#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/support/checkpoint.h"
#include "simulate/field/integrators/field_integrator.h"

namespace grainfield::simulate {

/// A wavevector of the lattice, k = 2π (nx/Lx, ny/Ly).
struct LatticeWave {
    int nx = 1;
    int ny = 0;
};

/// S(k) at chosen wavevectors without any noise of the density. Given a path of ψ,
///
///   S(k) = C1 ∫_0^∞ ‖∇φ‖² dt,   ∂tφ = ∇·(D(ψ)∇φ),   φ(0) = e^{ik·x}/sqrt(L^d),
///
/// averaged over paths: the propagator that carries noise forward is self-adjoint, and the
/// Ornstein–Uhlenbeck process of ψ is time-reversible, so that running φ forward visits the same
/// paths (docs/field/schemes.md). With the LOD scheme, whose sweeps do the same,
/// S = C1 dt Σ_steps Σ_i ‖∂_i(φ_before + φ_after)/2‖² is the structure factor of that scheme,
/// bias of the time step included.
///
/// A stretch of fixed length gives one sample and the next begins: beginning when φ has died out
/// would draw more beginnings from times of fast diffusion and bias S low (5 % at k = 1.2, ν =
/// .005). The length of a wavevector is 1.5 times what ‖φ‖² takes to fall to `rest` in a first
/// stretch, which is discarded. What is left of φ at the end counts as its share of S, S = sum/(1 −
/// ‖φ‖²). Samples of one wavevector are nearly independent; those of different ones share ψ. Best
/// at small k, where a noisy density needs 1/(D k²) for each sample; heavy-tailed at large k and
/// small ν, where a stretch is short against 1/ν: there run the density.
class AdjointEstimator {
 public:
    /// `setup.replicas` and noise do not matter. Throws OptionError for k = 0, a wave beyond the
    /// lattice, no waves, or D0 = 0 (φ never decays).
    AdjointEstimator(const FieldSetup& setup, std::vector<LatticeWave> waves, int threads,
                     double rest = 1e-4);
    ~AdjointEstimator();
    AdjointEstimator(AdjointEstimator&&) noexcept;

    void advance(std::int64_t steps);
    std::int64_t step() const;
    double time() const;

    double wavenumber(std::size_t wave) const;  ///< |k|
    /// S of each stretch that ended, in order of time.
    const std::vector<double>& samples(std::size_t wave) const;
    /// C1 ∫‖∇φ‖² dt of the stretch under way: with rest = 0, which none reaches, that since the
    /// beginning.
    double under_way(std::size_t wave) const;
    std::size_t waves() const;

    void save(Checkpoint& checkpoint) const;
    void restore(const Checkpoint& checkpoint);

 private:
    class State;
    template <class Real>
    class Engine;
    std::unique_ptr<State> state_;
};

}  // namespace grainfield::simulate
