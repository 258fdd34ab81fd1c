#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/pattern.h"
#include "analysis/statistics/blocks.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

/// The structure factor at given wavevectors, whatever they are: curve `sk_list` (kx, ky, s, s_err,
/// s_raw) of the observable "sk".
///
///   raw        S(k) = ⟨|ρ_k|²⟩/⟨N⟩,   ρ_k = Σ_j exp(−ik·r_j)
///   connected  S(k) = M/(M − 1) · (⟨|ρ_k|²⟩ − |⟨ρ_k⟩|²)/⟨N⟩
///
/// The column `s` is the connected one between walls from two frames on, else the raw one. M is the
/// number of independent frames as in StructureFactor, here of one wavevector alone, so known to a
/// fifth or so. Vectors that do not fit the box (no multiples of 2π/L, of π/L between walls) see
/// its shape: their raw S has the square of its Fourier transform in it, and in a periodic box they
/// depend on where the box is cut.
///
/// Error: jackknife over blocks with Student's factor from eight frames on; below that frames are
/// taken as independent and S as a mean of ν exponentially distributed numbers, ν = M (raw), M − 1
/// (connected): error² = S² (ν + 2)/((ν − 1)(ν − 2)), none for ν ≤ 2. None either where the modes
/// change too slowly for a run of this length, as in StructureFactor, or do not change at all.
///
/// Direct sum: some 30 ns a particle and wavevector. Memory: 16 blocks × 40 B a wavevector.
class ListedModes {
 public:
    struct Sample {
        double particles = 0;
        std::vector<std::complex<double>> rho;
    };

    /// `wavevectors` [1/a]. Throws OptionError if one is not finite or there are more than 2^20.
    /// Of a part of a run `frames` is the length of the run, `first` the number of its first frame.
    ListedModes(std::vector<Vec2> wavevectors, const Box& box, std::int64_t frames,
                std::int64_t first = 0);

    /// Thread-safe.
    Sample measure(const Pattern& pattern) const;
    void add(Sample sample);
    void merge(const ListedModes& later);
    /// The sums gathered so far, under names that begin with `prefix`; `restore` takes them into an
    /// accumulator of the same wavevectors. Throws InputError if they do not fit.
    void save(Checkpoint& checkpoint, const std::string& prefix) const;
    void restore(const Checkpoint& checkpoint, const std::string& prefix);

    /// Appends the curve; nothing without frames or particles.
    void add_to(ObservableResult& sk) const;

 private:
    struct Block {
        double frames = 0;
        double particles = 0;
        std::vector<std::complex<double>> rho;
        std::vector<double> power;
    };
    Block empty_block() const;
    Block total(std::optional<std::size_t> without) const;
    std::vector<BlockDrift> drifts() const;
    double independent_frames(const Block& sums, std::size_t mode) const;
    double value(const Block& sums, std::size_t mode, bool is_connected, double independent) const;
    std::optional<double> error(std::span<const Block> left_out, std::size_t mode,
                                bool is_connected, double s, double independent) const;

    std::vector<Vec2> wavevectors_;
    Box box_;
    BlockPlan plan_;
    std::int64_t first_;  // of the run
    std::int64_t added_ = 0;
    std::vector<Block> blocks_;
};

}  // namespace grainfield::analysis
