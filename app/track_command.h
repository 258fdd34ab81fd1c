#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/live/live_job.h"
#include "pipelines/track/track_job.h"

namespace grainfield::app {

/// `grainfield track`: camera frames to a trajectory file.
class TrackCommand : public Command {
 public:
    std::string name() const override { return "track"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    void make_room_for(const GivenText& given) override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary run_live(Session& session) const;

    std::string output_;
    double checkpoint_every_ = 1;  ///< [min]
    pipelines::TrackJobOptions job_;
    pipelines::LiveJobOptions live_;
};

}  // namespace grainfield::app
