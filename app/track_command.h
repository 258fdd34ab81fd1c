#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "app/command.h"
#include "core/frame_source.h"
#include "io/frame_region.h"
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
    /// Frames as the tracker sees them: over the flat field, the region alone.
    std::unique_ptr<FrameSource> corrected(std::unique_ptr<FrameSource> frames,
                                           const std::optional<io::FrameRegion>& region) const;
    void warn_of_unit(const tracking::Tracker& tracker, RunPlan& plan) const;

    std::string output_;
    std::optional<double> fps_;
    std::string frames_ = "::";
    std::string region_;
    std::string flat_field_;
    std::int64_t previews_ = 3;
    std::int64_t max_pixels_ = 200'000'000;
    bool strict_ = false;
    tracking::TrackOptions tracking_;
};

}  // namespace grainfield::app
