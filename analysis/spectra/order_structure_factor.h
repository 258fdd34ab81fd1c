#pragma once

#include <complex>
#include <cstdint>
#include <span>

#include "analysis/spectra/structure_factor.h"

namespace grainfield::analysis {

struct OrderStructureFactorOptions {
    StructureFactorOptions modes{.k_max = 1};  ///< wavevectors, as of S(k)
    double fit_k_max = 0.5;                    ///< end of the Ornstein–Zernike fit [1/a]
};

OptionTable describe(OrderStructureFactorOptions& options);

/// The observable "s4": structure factor of the bond-orientational order (`castillo2012`),
///
///   S4(k) = (⟨|Q_k|²⟩ − |⟨Q_k⟩|²)/⟨N⟩,   Q_k = Σ_j Q4^j exp(−ik·r_j),
///
/// averaged over shells of |k|, over k and −k (which differ, as Q4 is complex), and over frames;
/// for periodic boxes and single frames without the second term. Estimator, shells, errors and
/// numbers of independent samples are those of StructureFactor; N counts the particles that have a
/// Q4.
///
/// Ornstein–Zernike fit over k ≤ fit_k_max (fit_ornstein_zernike): `s4_zero` = S4(0), `xi4` [a],
/// curve `s4_fit`. There is none where S4 is not steady (`s4_growth`, StructureFactor::growth). At
/// large k S4 tends to ⟨|Q4|²⟩, which the form does not know.
///
/// Memory: 16 blocks × 80 B × modes.
class OrderStructureFactor {
 public:
    using Sample = StructureFactor::Sample;

    OrderStructureFactor(const OrderStructureFactorOptions& options, const Box& box,
                         std::int64_t frames, std::int64_t first = 0);

    /// `order`: Q of each particle of the pattern. Thread-safe.
    Sample measure(const Pattern& pattern, std::span<const std::complex<double>> order) const {
        return modes_.measure(pattern, order);
    }
    void add(Sample sample) { modes_.add(std::move(sample)); }
    void merge(const OrderStructureFactor& later) { modes_.merge(later.modes_); }
    /// As of StructureFactor.
    void save(Checkpoint& checkpoint, const std::string& prefix) const {
        modes_.save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) {
        modes_.restore(checkpoint, prefix);
    }
    ObservableResult result() const;

 private:
    OrderStructureFactorOptions options_;
    StructureFactor modes_;
};

}  // namespace grainfield::analysis
