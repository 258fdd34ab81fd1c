#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/results.h"
#include "simulate/md/engine/engine.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

/// The time series of a run: at each sample the energies, and what happened since the last one.
class MdSeries {
 public:
    explicit MdSeries(const MdSystem& system, std::int64_t grains);

    /// `periods`: time of the sample, `energies` at it; `sums`: everything since the run began;
    /// `kinetic`: translational energy, mean over the phases since the last sample.
    void add(double periods, const Energies& energies, const std::vector<double>& sums,
             double kinetic);

    std::size_t size() const { return rows_; }
    std::size_t columns() const { return curve_.columns.size(); }
    /// Curve "md" with columns t, events per grain, energies [m g a per grain], impulses …
    const Curve& curve() const { return curve_; }

    /// Row after row, for a checkpoint; the first `rows` of them.
    std::vector<double> numbers(std::size_t rows) const;
    void restore(const std::vector<double>& numbers, const std::vector<double>& last_sums);

    /// Mean of a column over the later half of the samples; 0 without samples.
    double late_mean(const std::string& column) const;

 private:
    std::vector<double>& column(std::size_t i) { return curve_.columns[i].values; }

    MdSystem system_;
    double grains_;
    std::size_t rows_ = 0;
    double last_periods_ = 0;
    double audit_origin_ = 0;
    std::vector<double> last_sums_;
    Curve curve_;
};

/// The numbers of a ledger in a fixed order, to be added up over windows.
std::vector<double> sums_of(const Ledger& ledger);
enum SumIndex : std::size_t {
    sum_pair,
    sum_low,
    sum_high,
    sum_wall,
    sum_sliding,
    sum_contact_time,
    sum_resting,
    sum_pair_loss,
    sum_plate_loss,
    sum_work,
    sum_low_impulse,
    sum_high_impulse,
    sum_virial,
    sum_count
};

}  // namespace grainfield::simulate
