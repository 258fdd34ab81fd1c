#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/pattern.h"
#include "analysis/spectra/density_modes.h"
#include "analysis/spectra/density_transform.h"
#include "analysis/statistics/blocks.h"
#include "analysis/statistics/spectrum_fit.h"
#include "core/density_field.h"
#include "core/option_table.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

/// Which multiples make the wavevector grid.
enum class WaveGrid {
    automatic,  ///< 2π/L on periodic axes, π/L on walled ones
    two_pi,     ///< 2π n/L
    pi          ///< π n/L
};

struct StructureFactorOptions {
    double k_max = 2;  ///< largest |k| [1/a]
    WaveGrid grid = WaveGrid::automatic;
    std::optional<double> shell_width{};  ///< width of the isotropic average [1/a]; auto: below
    std::vector<double> edges{};          ///< of annuli of |k| [1/a], in place of shells; or empty
};

/// S(k) of the last third of a run over that of its first third: the mean of S/S_run over the
/// waves of a range, each of the same weight.
struct SpectrumGrowth {
    double ratio = 1;    ///< [-]
    double error = 0;    ///< standard error in a steady state, to first order in ln(ratio)
    double k_end = 0;    ///< end of the range [1/a]
    double samples = 0;  ///< independent ones of each third

    /// Whether ln(ratio) is within 3.5 standard errors of zero, or within a tenth: so little
    /// changes no S0/S1.
    bool is_steady() const;
};

/// As a measurement, `symbol`_growth.
Measurement measured_growth(const std::string& symbol, const SpectrumGrowth& growth);
/// Why nothing is fitted to a spectrum that is not steady.
std::string not_steady(const std::string& symbol, const SpectrumGrowth& growth);

OptionTable describe(StructureFactorOptions& options, const std::string& section = "sk");
/// The edges as an option has them: "0.05,0.1,0.2".
std::string edges_text(const StructureFactorOptions& options);

/// The observable "sk": static structure factor at small wavevectors, from density modes ρ_k of
/// particles or fields (`castillo2019`; docs/analysis/spectra.md).
///
///   raw        S(k) = ⟨|ρ_k|²⟩ / ⟨N⟩                                  (curve `sk_raw`)
///   connected  S(k) = M/(M − 1) · (⟨|ρ_k|²⟩ − |⟨ρ_k⟩|²) / ⟨N⟩         removes walls and gradients
///   Neumann    S(k) = 4 M/(M − 1) · var(c_k) / ⟨N⟩,  c_k = Σ cos(k_x x) cos(k_y y), n_x, n_y > 0
///                                                                     (curve `sk_neumann`, walls)
///
/// Curve `sk` is the connected one for two or more frames with walls, the raw one for periodic
/// boxes (where ⟨ρ_k⟩ = 0) and, with a stated reason, for one frame. M is the number of
/// independent frames behind a shell, estimated from the scatter of block means (at most the number
/// of frames; equal to it below 17 frames) and given in the curve `sk_samples`. M/(M − 1) is M'/(M'
/// − 1) with M' from frames_of_mean: from 12 blocks of time on blocks that are alike, where modes
/// are slow, leave fewer frames behind the mean. Shells within a fifth in k tell that together.
///
/// Isotropic average over shells of |k| (half plane), by default every distinct |k| below 5.5 grid
/// steps and shells one step wide above; or over given annuli e_i ≤ |k| < e_{i+1} (the last one
/// closed), whatever lies outside left out: k is the mean |k| of the modes, n their number. In a
/// walled box plane waves on the π/L grid are correlated and leak (docs/analysis/spectra.md): use
/// `sk_neumann` for the limit k → 0.
///
/// No error, and a reason, where blocks next to each other are more alike than blocks in general
/// (von Neumann's ratio of the block means below a half, `vonneumann1941`): such modes change
/// too slowly for a run of this length (`least_step_ratio`), and no average over it can tell their
/// spread; the connected S is too low there.
///
/// Error: jackknife over K ≤ 16 blocks of time, times sqrt((K − 1)/(K − 3)), the spread of
/// Student's t: (S − true S)/error has variance one for small K too. Below eight frames the frames
/// are taken as independent, which is said, and S as the mean of ν exponentially distributed
/// numbers (a gamma distribution),
///
///   error² = S² (ν + 2)/((ν − 1)(ν − 2)),  ν = n_eff M (raw), n_eff (M − 1) (connected; Neumann,
///   whose modes are real: half of it),  n_eff = n²/Σ_kk' |c(k − k')|²  over the modes of a shell,
///
/// c the overlap of two plane waves in the box (product of sin(x)/x, x = Δk L/2), so that again
/// (S − true S)/error has variance one; none for ν ≤ 2. Samples: M n_eff.
///
/// Directions: curve `sk_map` (kx, ky, s) holds S of each wavevector of the half plane, at most
/// 20,000 of them; curve `sk_anisotropy` and the measurements anisotropy_2 and anisotropy_4 the
/// relative amplitude of its harmonics, over the modes of a shell or over all shells,
///
///   A_m = 2 |Σ_k (S(k)/S_shell − 1) exp(i m θ_k)|/n,   m = 2, 4,
///
/// which is some sqrt(π/(ν + 1)) on average for an isotropic pattern, ν the degrees of freedom; the
/// exact mean for the directions and overlaps of the modes of the grid stands beside it (chance2,
/// chance4). Error: jackknife with Student's factor, from eight blocks on.
///
/// Memory: 16 blocks × 56 B × modes, whatever the number of frames; more than 2 GB is refused
/// (OptionError) before it is taken.
class StructureFactor {
 public:
    struct Sample {
        double particles = 0;
        std::vector<std::complex<double>> rho;  ///< component after component
    };

    /// The grid is that of `box` [a]; all later patterns must have the same one. Of a part of a run
    /// `frames` is the length of the run, `first` the number of its first frame: parts then have
    /// the blocks of the run when they are merged.
    StructureFactor(const StructureFactorOptions& options, const Box& box, std::int64_t frames,
                    std::int64_t first = 0);

    /// Of a field on a periodic lattice: wavevectors up to options.k_max or the lattice's π/dx,
    /// whichever is less. `instants`: the blocks of time. Of each instant `replicas` fields are
    /// added, one after the other, all to one block.
    static StructureFactor of_field(const StructureFactorOptions& options,
                                    const DensityField& field, const BlockPlan& instants,
                                    std::int64_t replicas = 1);

    /// Of a complex order parameter that particles carry, Q_k = Σ_j Q^j exp(−ik·r_j): what
    /// `OrderStructureFactor` wraps. The real and the imaginary part are two components, whose
    /// powers add: the mean of S at k and −k. No Neumann estimator.
    static StructureFactor of_order(const StructureFactorOptions& options, const Box& box,
                                    std::int64_t frames, std::int64_t first = 0);

    /// Thread-safe. Throws InputError if the pattern's box is another one.
    Sample measure(const Pattern& pattern) const;
    /// Of an order parameter, one value a particle; those that are not finite count as absent.
    Sample measure(const Pattern& pattern, std::span<const std::complex<double>> order) const;

    /// Of a field: ρ_k = Σ ρ(r) dx^d exp(−ik·r) over the cells by FFT, and the volume L^d in the
    /// place of N, so that raw S(k) = ⟨|ρ_k|²⟩/L^d. `dimension` 1: dx^d = dx. Modes of cells and of
    /// corners differ by a phase only. Thread-safe. Throws InputError if the lattice is another
    /// one.
    Sample measure(const DensityField& field, int dimension) const;
    void add(Sample sample);
    void merge(const StructureFactor& later);
    ObservableResult result() const;

    /// The sums gathered so far, under names that begin with `prefix`; `restore` takes them into an
    /// accumulator built with the same options. Throws InputError if they do not fit.
    void save(Checkpoint& checkpoint, const std::string& prefix) const;
    void restore(const Checkpoint& checkpoint, const std::string& prefix);

    /// Goes on with the blocks of a run that became longer, a lengthened plan of its own.
    void lengthen(const BlockPlan& plan);

    const ModeGrid& grid() const { return grid_; }

    /// How so many particles are taken to wavevectors, in words.
    std::string method(std::size_t particles) const;

    enum class Estimator { raw, connected, neumann };

    /// What the measurements allow: modes between walls (from two frames on), connected, raw.
    bool allows(Estimator estimator) const;

    /// S(k) with its degrees of freedom ν, for fits. ν = n_eff T/g (half of it for the real Neumann
    /// modes; times (M − 1)/M where the mean is subtracted): T frames, and g the correlation of
    /// |ρ_k|², (1 + r²)/(1 − r²), from that of ρ_k, (1 + r)/(1 − r), as for a mode that relaxes
    /// exponentially; r from the scatter of the blocks, smoothed over k and corrected for their
    /// finite length. `times`: how often each block of time is taken, for the bootstrap;
    /// empty: once. The degrees of freedom are always those of all blocks.
    Spectrum spectrum(Estimator estimator, std::span<const int> times = {}) const;

    /// The growth of S up to k_max, k_max/2 or k_max/4 [1/a]: of the three the one farthest from 1
    /// in its errors. Where a layer separates, S of the lowest waves grows first.
    ///
    /// Thirds are blocks of time from each end, until they hold a third of the frames. Power is
    /// that about the mean of the run. The error is the larger of two: that of ν/3 exponentially
    /// distributed numbers (in a periodic box at least one look at each wave), and from 12 blocks
    /// on that from the scatter of the blocks in each third. Shells without ν are left out: between
    /// walls those that are too slow. Nothing with fewer than three blocks, or where a range has
    /// fewer than four waves or a third fewer than two samples.
    ///
    /// Of 1,000 steady runs at most 3 are found to grow or to fall
    /// (tests/analysis/spectra/structure_factor_growth_test.cpp, with as many runs).
    std::optional<SpectrumGrowth> growth(Estimator estimator, double k_max) const;
    std::size_t blocks() const { return blocks_.size(); }
    /// Numbers of the blocks that a frame came to: all, but of a run that was cut short or lacks a
    /// part.
    std::vector<std::size_t> filled_blocks() const;
    bool is_periodic() const { return box_.is_periodic(); }
    bool counts_particles() const { return counts_particles_; }  ///< false: the volume of fields
    double particles_mean() const;  ///< per frame; of fields their volume; 0 without frames
    const Box& box() const { return box_; }

 private:
    struct Block {
        double frames = 0;
        double particles = 0;
        std::vector<std::complex<double>> rho;  // Σ ρ, component after component
        std::vector<double> power;              // Σ |ρ|², all components together
        std::vector<double> cosine;             // Σ c
        std::vector<double> cosine2;            // Σ c²
    };
    static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

    struct Shells {
        std::vector<double> k;
        std::vector<double> modes;
        std::vector<std::vector<std::size_t>> members;
    };
    bool has_neumann() const;
    Shells shells(Estimator estimator) const;
    double deviation(const Block& part, const Block& run, Estimator estimator,
                     std::size_t mode) const;
    double mode_value(const Block& sums, Estimator estimator, std::size_t mode) const;
    std::vector<double> samples(const Shells& shells, Estimator estimator) const;
    std::vector<BlockDrift> drifts(const Shells& shells, Estimator estimator) const;
    std::vector<double> samples_of_mean(const std::vector<double>& samples,
                                        const std::vector<BlockDrift>& drifts) const;
    std::vector<double> independent_modes(const Shells& shells, Estimator estimator) const;
    std::vector<double> few_frames_error(const Shells& shells, Estimator estimator,
                                         const std::vector<double>& s) const;
    std::vector<double> averages(const Shells& shells, const Block& sums, Estimator estimator,
                                 const std::vector<double>& samples) const;
    const char* symbol() const;  ///< "S(k)", of the order "S4(k)"
    Curve curve(const char* name, const char* method, Estimator estimator) const;
    Curve samples_curve(const char* name, Estimator estimator) const;
    /// Amplitudes of the two- and four-fold harmonic of each shell, and over all shells at the end.
    std::array<std::vector<double>, 2> anisotropies(const Shells& shells, const Block& sums,
                                                    Estimator estimator) const;
    std::array<std::vector<double>, 2> anisotropies_by_chance(const Shells& shells,
                                                              Estimator estimator) const;
    Curve map_curve(Estimator estimator) const;
    void add_directions(ObservableResult& result, Estimator estimator) const;
    void add_measurements(ObservableResult& result, Estimator best,
                          const std::string& reason) const;
    Block total(std::optional<std::size_t> without) const;
    Block total_of(std::span<const int> times) const;
    Block empty_block() const;
    static void add_block(Block& to, const Block& from, double weight);
    void require_same_box(const Pattern& pattern) const;

    StructureFactorOptions options_;
    Box box_;
    BlockPlan plan_;
    std::vector<double> edges_;  // of annuli; empty: shells
    ModeGrid grid_;
    std::shared_ptr<const DensityTransform> transform_;  // of particles
    std::size_t components_ = 1;
    bool counts_particles_ = true;
    std::int64_t first_ = 0;     ///< of the run
    std::int64_t replicas_ = 1;  ///< samples of one instant
    std::int64_t added_ = 0;
    std::vector<Block> blocks_;
    std::vector<std::size_t> neumann_index_;  // of each mode in `cosine`, or nowhere
    std::vector<std::size_t> neumann_modes_;
};

}  // namespace grainfield::analysis
