#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/command.h"
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
    void warn_of_unit(const tracking::Tracker& tracker, RunPlan& plan) const;

    std::string output_;
    std::optional<double> fps_;
    std::string frames_ = "::";
    std::int64_t previews_ = 3;
    std::int64_t max_pixels_ = 200'000'000;
    bool strict_ = false;
    tracking::TrackOptions tracking_;
};

}  // namespace grainfield::app
