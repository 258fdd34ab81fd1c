#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/frame_source.h"
#include "core/trajectory.h"
#include "pipelines/job.h"
#include "pipelines/render/rendered_frames.h"
#include "simulate/md/md_options.h"
#include "simulate/render/render_options.h"

namespace grainfield::pipelines {

/// Where the frames of a validation and their truth come from.
struct SceneOptions {
    SceneOptions();

    std::string trajectory;  ///< to render instead of a new run; empty: none
    std::string truth;       ///< true positions of the frames that are given [px]; empty: none
    /// A crystal patch that melts at its rim in a liquid, walls out of sight; 41 frames a tenth of
    /// a period apart.
    simulate::MdOptions md;
    simulate::RenderOptions render;
};

/// Frames and truth, and what has to live as long as they do.
struct ValidationScene {
    std::unique_ptr<SnapshotSource> trajectory;  ///< what the frames show; none if given
    std::unique_ptr<FrameSource> frames;
    RenderedFrames* rendered = nullptr;  ///< the same frames, if they were rendered
    std::unique_ptr<SnapshotSource> truth;
    std::optional<double> sphere_diameter;      ///< [px]
    std::optional<double> vibration_frequency;  ///< [1/time unit of the truth]
};

/// Opens the frames that are inputs of the job, or simulates and renders them. What was read
/// besides is added to the inputs. Throws OptionError, InputError, Interrupted.
ValidationScene open_scene(const SceneOptions& options, Job& job);

/// The same without simulating: enough for the plan.
ValidationScene plan_scene(const SceneOptions& options, Job& job);

}  // namespace grainfield::pipelines
