#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/command.h"
#include "core/support/checkpoint.h"
#include "pipelines/md/snapshot_segments.h"
#include "simulate/md/grain_state.h"
#include "simulate/md/md_options.h"

namespace grainfield::simulate {
class MdSimulation;
}

namespace grainfield::io {
class TrajectoryWriter;
}

namespace grainfield::app {

/// `grainfield simulate md`: a vibrated layer to a trajectory file.
class SimulateMdCommand : public Command {
 public:
    std::string name() const override { return "simulate md"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    simulate::GrainState initial_state(const Session& session) const;
    /// What a resumed run must have in common with the one before.
    std::vector<std::pair<std::string, std::string>> physics(const Session& session) const;
    void run_to_end(Session& session, simulate::MdSimulation& simulation,
                    pipelines::SnapshotSegments& segments) const;
    void plan_snapshots(RunPlan& plan) const;
    void save(const Session& session, const simulate::MdSimulation& simulation,
              pipelines::SnapshotSegments& segments) const;
    /// The checkpoint of this very run; nothing without --resume.
    std::optional<Checkpoint> load_checkpoint(const Session& session) const;
    std::int64_t segments_of(const Checkpoint& checkpoint) const;
    /// Joins snapshots and time series to the output file; throws Interrupted, leaving the
    /// segments.
    void finish(Session& session, const simulate::MdSimulation& simulation,
                pipelines::SnapshotSegments& segments, io::TrajectoryWriter& writer) const;
    std::filesystem::path checkpoint_path() const { return output_ + ".checkpoint"; }

    std::string output_;
    std::string start_;
    std::int64_t start_frame_ = -1;
    bool resume_ = false;
    bool order_ = false;
    double checkpoint_every_ = 10;
    simulate::MdOptions md_;
};

}  // namespace grainfield::app
