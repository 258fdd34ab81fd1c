#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/pattern.h"
#include "analysis/statistics/blocks.h"
#include "core/option_table.h"
#include "core/results.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

struct PairDistributionOptions {
    double range = 5;                ///< largest distance of a pair [a]; at most half the box
    double bin = 0.02;               ///< width of the bins [a]
    std::optional<double> border{};  ///< strip left free along walls [a]; auto: 10, at most L/10
    double contact = 1.1;            ///< spheres nearer in space touch [a]
    std::int64_t frames = 64;        ///< most frames that are used, evenly spread; 0: all
};

OptionTable describe(PairDistributionOptions& options);

/// The observable "gr": pair distribution functions in the plane and, where heights are known, in
/// space, with the numbers of contacts.
///
///   g(r) = Σ_{i≠j} [r_ij in the bin] A/A_w(s_ij)  /  Σ_{i≠j} V(z_i − z_j)/A
///
/// s_ij is the vector from i to j in the plane, r_ij its length (in the plane) or the distance in
/// space. A [a²] is the area of the window: the box less a strip along
/// walls, where density is not that of the bulk and films show no centres. A_w(s) = (Lx − |s_x|)
/// (Ly − |s_y|) is the area that the window and the window displaced by s share: it makes up for
/// the pairs that its sides cut off (translation correction, `stoyan1994`). On periodic axes
/// nothing is cut off and L stands alone. V(h) is the area of the ring that the bin leaves in the
/// plane at the difference of heights h,
///
///   V(h) = π max(0, r₂² − h²) − π max(0, r₁² − h²),      h = 0 in the plane.
///
/// The expectation is that of the same heights at random places. So g → 1 at large r in a shallow
/// layer too, where most pairs lie beside each other: the profile of heights is no correlation.
/// Sums of frames are divided, not means of ratios.
///
/// Curve `gr`: s, g, err, n (pairs). Curve `gr_space`: r, g, err, n, neighbours (mean number of
/// spheres within r). Curve `contacts`: share of spheres with n contacts. Spheres nearer than
/// `contact` to a wall are not counted as centres. No number of contacts where less than 0.9 of
/// the heights are known, or more than 0.05 of the spheres are too near to another. Only spheres
/// with a known height enter the last two; where some are unknown, contacts are too few, and
/// `known_heights` says by how much.
///
/// Validity: homogeneous layers. Error:
/// left_out_error of at most 16 blocks of time; below four frames g/√n of n pairs, which takes them
/// as independent. The last row of `contacts` is 16 or more. The peak is the largest bin beyond 0.5
/// a with 20 pairs.
///
/// Cost O(N ρ range²) a frame that is used, ρ the number per area of the projection. Memory: 48 B a
/// bin for each of 16 blocks, 200 kB with 250 bins.
class PairDistribution {
 public:
    /// Sums of one frame; those of `weight` have A/A_w.
    struct Sums {
        std::vector<double> weight, expected;  ///< per bin
        std::vector<std::int64_t> pairs;       ///< per bin, each once
        void add(const Sums& more);
    };
    /// Of one frame or of a block of them.
    struct Counts {
        std::int64_t frames = 0;  ///< that were used
        double particles = 0;     ///< in the window
        double known = 0;         ///< of them, with a known height
        Sums plane, space;
        std::vector<std::int64_t> spheres_with;  ///< n contacts; the last: so many or more
        std::int64_t contacts = 0;               ///< of all of them
        std::int64_t too_near = 0;               ///< of them, with one nearer than 0.95 a
    };
    using Sample = Counts;  ///< without frames where the frame is not used

    /// Of a part of a run `frames` is the length of the run, `first` the number of its first frame.
    PairDistribution(const PairDistributionOptions& options, const Box& box, std::int64_t frames,
                     std::int64_t first = 0);

    /// The number of frames from one that is used to the next.
    static std::int64_t stride(const PairDistributionOptions& options, std::int64_t frames);

    /// Of the frame that will be added as number `ordinal` of the run. Thread-safe. Throws
    /// InputError if the box is another one.
    Sample measure(const Pattern& pattern, std::int64_t ordinal) const;
    void add(const Sample& sample);
    void merge(const PairDistribution& later);
    ObservableResult result() const;

    /// The sums gathered so far, under names that begin with `prefix`; `restore` takes them into an
    /// accumulator built with the same options. Throws InputError if they do not fit.
    void save(Checkpoint& checkpoint, const std::string& prefix) const;
    void restore(const Checkpoint& checkpoint, const std::string& prefix);

 private:
    static constexpr std::size_t most_contacts = 16;  // more count as so many
    static constexpr double too_near = 0.95;          // no two hard spheres are so near [a]
    using Block = Counts;
    Block empty_block() const;
    static void add_block(Block& to, const Block& from);
    Block total() const;
    void count(const Pattern& pattern, const Box& window, Sample& sample) const;
    void expect(std::vector<double> z, double area, Sums& sums) const;
    std::vector<double> errors(const Block& all, Sums Block::*sums) const;
    Curve curve(const Block& all, Sums Block::*sums, const char* name, const char* title,
                const char* distance) const;
    void add_peak(const Curve& plane, ObservableResult& result) const;
    void add_space(const Block& all, ObservableResult& result) const;

    PairDistributionOptions options_;
    Box box_;
    Box window_;
    std::size_t bins_ = 0;
    BlockPlan plan_;
    std::int64_t first_;   // of the run
    std::int64_t stride_;  // of the frames that are used
    std::int64_t added_ = 0;
    std::vector<Block> blocks_;
};

}  // namespace grainfield::analysis
