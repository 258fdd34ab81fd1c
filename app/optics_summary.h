#pragma once

#include <cstdint>

#include "app/command.h"
#include "simulate/render/renderer.h"
#include "simulate/render/sampling_check.h"

namespace grainfield::app {

/// Adds to `summary` what ray tracing took: rays and samples per pixel of the frame, the share of
/// pixels without any ray, the rays saved against uniform sampling and what that costs in accuracy.
/// For silhouettes the counts are 0 and no line is added. And how many flights between snapshots
/// were followed through a collision.
void add_optics_summary(const simulate::Renderer& renderer, std::int64_t frames,
                        const simulate::SamplingCheck& check, Summary& summary);

/// Says in the plan what the check found: what ray tracing will take and save. Nothing for
/// silhouettes.
void explain_rays(const simulate::SamplingCheck& check, RunPlan& plan);

}  // namespace grainfield::app
