#pragma once

#include <cstdint>
#include <string>

#include "app/command.h"
#include "pipelines/film/film.h"
#include "pipelines/track/track_checkpoint.h"
#include "tracking/tracker.h"

namespace grainfield::app {

/// `grainfield track`: camera frames to a trajectory file.
class TrackCommand : public Command {
 public:
    std::string name() const override { return "track"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    void plan_checkpoints(const pipelines::TrackCheckpoint& saved, std::int64_t frames,
                          RunPlan& plan) const;
    void warn_of_unit(const tracking::Tracker& tracker, RunPlan& plan) const;

    std::string output_;
    pipelines::FilmOptions film_;
    std::int64_t previews_ = 3;
    pipelines::TrackCheckpoint::Options checkpoint_;
    tracking::TrackOptions tracking_;
};

}  // namespace grainfield::app
