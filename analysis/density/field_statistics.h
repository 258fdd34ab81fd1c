#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/density/field_variance.h"
#include "analysis/spectra/structure_factor.h"
#include "analysis/statistics/blocks.h"
#include "core/density_field.h"
#include "core/figure_hint.h"
#include "core/quantity_titles.h"
#include "core/results.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

/// What is measured on the fields of a run as they come, so that none need be stored: a sink.
///
///   sk         S(k) = ⟨|ρ_k|²⟩/L^d of the density (StructureFactor, the estimator of particles)
///   sk_order   the same of ψ, up to its largest k
///   variance   variance of the content of windows (FieldVariance)
///   field      ⟨ψ²⟩, ⟨D⟩, mean density
///
/// Replicas count as fields of the same instant; blocks of time hold all replicas of their
/// instants, so that errors are honest though replicas share ψ. S and its errors are summed in
/// double whatever the precision of the simulation. The state can be saved and taken up again bit
/// by bit, also by a run that became longer: its blocks are then BlockPlan::lengthened.
class FieldStatistics : public FieldSink {
 public:
    /// `instants`: how many there will be, for the blocks. `order_k_max` [1/l]: ψ has no modes
    /// above; what rounding leaves there is no spectrum.
    FieldStatistics(const StructureFactorOptions& options, std::int64_t instants,
                    double order_k_max = std::numeric_limits<double>::infinity())
        : options_(options), plan_(BlockPlan::of(instants)), order_k_max_(order_k_max) {}

    void write(const FieldFrame& frame) override;
    std::int64_t count() const { return static_cast<std::int64_t>(diffusivity_.value.size()); }
    std::vector<ObservableResult> results() const;

    /// The S(k) of the density; null before the first field.
    const StructureFactor* density() const { return sums_ ? &sums_->density : nullptr; }

    void save(Checkpoint& checkpoint) const;
    /// `like`: any frame of the run, for the lattice. The checkpoint may be of a run of another
    /// length. Throws InputError if the state does not fit.
    void restore(const Checkpoint& checkpoint, const FieldFrame& like);

 private:
    struct Accumulators {
        StructureFactor density;
        std::optional<StructureFactor> order;
        FieldVariance variance;
    };
    void prepare(const FieldFrame& like);
    ObservableResult means() const;

    StructureFactorOptions options_;
    BlockPlan plan_;  // of instants
    double order_k_max_;
    std::optional<Accumulators> sums_;
    MeanSeries order_squared_, diffusivity_, mean_density_;
};

/// How the curves that only fields have want to be drawn.
std::vector<FigureHint> field_figures();
/// What the observables that only fields have are called.
std::vector<ObservableTitles> field_titles();

}  // namespace grainfield::analysis
