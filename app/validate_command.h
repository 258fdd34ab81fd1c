#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/figures_folder.h"
#include "core/stored_trajectory.h"
#include "pipelines/render/rendered_frames.h"
#include "pipelines/validate/validation.h"
#include "pipelines/validate/validation_thresholds.h"
#include "report/report.h"
#include "simulate/md/md_options.h"
#include "simulate/render/render_options.h"

namespace grainfield::app {

/// `grainfield validate`: frames whose truth is known, tracked, and how well that meets the truth.
///
/// The frames are rendered from a run of molecular dynamics that the scene file describes, or from
/// a trajectory that exists; or they are given together with their truth.
class ValidateCommand : public Command {
 public:
    ValidateCommand();
    std::string name() const override { return "validate"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    /// Frames and truth, and what has to live as long as they do.
    struct Scene {
        std::unique_ptr<SnapshotSource> trajectory;  ///< what the frames show; none if given
        std::unique_ptr<FrameSource> frames;
        pipelines::RenderedFrames* rendered = nullptr;  ///< the same frames, if they were rendered
        std::unique_ptr<SnapshotSource> truth;
        std::optional<double> sphere_diameter;  ///< [px]
        std::optional<double> vibration_frequency;
    };
    Scene given_scene(Session& session) const;
    Scene rendered_scene(Session& session) const;
    std::unique_ptr<SnapshotSource> make_trajectory(Session& session) const;
    Summary finish(Session& session, const pipelines::ValidationOutcome& outcome,
                   const tracking::TrackSummary& tracked, io::OutputFile& html,
                   FiguresFolder* figures) const;

    std::string output_;
    std::string trajectory_;  ///< to render instead of a new run
    std::string truth_;       ///< of the frames given as input
    int previews_ = 1;
    report::ReportOptions report_;
    simulate::MdOptions md_;
    simulate::RenderOptions render_;
    tracking::TrackOptions tracking_;
    analysis::FitOptions fit_;
    pipelines::ValidationThresholds thresholds_;
};

}  // namespace grainfield::app
