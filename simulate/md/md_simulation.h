#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/run_plan.h"
#include "core/support/checkpoint.h"
#include "core/trajectory.h"
#include "simulate/md/engine/engine.h"
#include "simulate/md/md_options.h"
#include "simulate/md/md_series.h"

namespace grainfield::simulate {

/// A run of the vibrated layer from its initial state to its last period.
///
/// Time is cut into windows of a few periods (about 1e6 events, fixed by N alone). At their
/// borders all grains are flown to the same instant, from which everything that follows is
/// determined: a checkpoint is that state.
class MdSimulation {
 public:
    /// Throws OptionError or InputError if it cannot be run. Says in the plan what is skipped.
    MdSimulation(const MdOptions& options, GrainState initial, int threads, RunPlan& plan);

    /// Goes on where the checkpoint was made, bit by bit as if nothing had happened. Not so
    /// with another contact time: where there was none, collisions before are not remembered.
    /// Throws
    /// InputError, naming `file`, if an array is missing, of the wrong length, not finite or not
    /// what it must be.
    void restore(const Checkpoint& checkpoint, const std::string& file = "the checkpoint");

    /// Runs one window; snapshots that fall into it go to the sink. Returns early, with the window
    /// unfinished, once a signal was caught. Throws InelasticCollapse, after which checkpoint() is
    /// the state at the beginning of the window, and PhysicsError on overlap.
    void run_window(SnapshotSink& sink);

    bool is_done() const { return periods_done() >= options_.run.periods; }
    double periods_done() const;
    /// Snapshots and samples before the present window: what a checkpoint vouches for.
    std::int64_t settled_snapshots() const { return settled_snapshots_; }
    Checkpoint checkpoint() const;

    TrajectoryInfo info() const;
    const MdSeries& series() const { return series_; }
    double period() const { return system_.period(); }
    std::int64_t events() const;
    /// Deepest overlap of two grains, and of a grain with plates and walls [a], at all contacts so
    /// far and at the borders of windows.
    double max_overlap() const;
    double max_penetration() const { return deepest_plate_; }
    /// Greatest step back in time from one event to the next [sqrt(a/g)].
    double backwards() const { return backwards_; }
    /// Windows of this process that several threads had to leave to one.
    std::int64_t fallbacks() const { return engine_->fallbacks(); }
    /// |energy change + losses − work| over the energy turned over.
    double energy_audit() const;
    double outdated_per_event() const;
    std::size_t bytes() const;
    std::string policies() const { return engine_->policies(); }

 private:
    Snapshot snapshot(double time, std::int64_t frame) const;
    void sample(double time);
    void add_slice(double time);
    double permitted_depth(double time) const;
    bool advance_to(double time, double first);
    void settle();
    std::vector<double> present_sums() const;

    MdOptions options_;
    MdSystem system_;
    GrainState state_;  ///< at the beginning of the window
    std::unique_ptr<Engine> engine_;
    MdSeries series_;
    std::int64_t window_periods_ = 1;
    std::int64_t window_ = 0;
    std::int64_t next_snapshot_ = 0;
    std::int64_t settled_snapshots_ = 0;
    std::int64_t next_sample_ = 0;
    std::size_t settled_rows_ = 0;
    std::vector<double> sums_;          ///< of the windows before the present one
    std::vector<double> settled_last_;  ///< sums at the last sample before the present window
    std::vector<double> last_sample_sums_;
    double energy_start_ = 0;
    double energy_now_ = 0;
    double max_overlap_ = 0;  ///< at the borders of windows
    double deepest_pair_ = 0;
    double deepest_plate_ = 0;
    double backwards_ = 0;
    double outdated_ = 0;
    /// Translational energy over the phases since the last sample, for the pressure.
    struct Kinetic {
        double sum = 0;
        double slices = 0;
    };
    Kinetic kinetic_;
    Kinetic settled_kinetic_;
    double settled_energy_ = 0;
};

/// Throws PhysicsError with grain, partner, time and depth of the deepest contact of a window that
/// begins with period `first` (`period` in sqrt(a/g)) if it is deeper than `permitted` [a].
void require_clean_contacts(const Ledger& ledger, double permitted, double first, double period);

}  // namespace grainfield::simulate
