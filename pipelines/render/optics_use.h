#pragma once

#include <cstdint>

#include "core/run_plan.h"
#include "simulate/render/renderer.h"
#include "simulate/render/sampling_check.h"

namespace grainfield::pipelines {

/// What the optics of a renderer took; the counts of rays are 0 for silhouettes.
struct OpticsUse {
    double rays_per_pixel = 0;      ///< of the frame
    double samples_per_pixel = 0;   ///< of the frame
    double settled_pixels = 0;      ///< share of the pixels without any ray
    double rays_saved = 0;          ///< share, against uniform sampling
    simulate::FlightTally flights;  ///< between snapshots
    simulate::SamplingCheck check;  ///< what adaptive sampling changes; size 0: not measured
};

/// Of a renderer that made `frames` images.
OpticsUse optics_use(const simulate::Renderer& renderer, std::int64_t frames,
                     const simulate::SamplingCheck& check);

/// Says in the plan what ray tracing will take and save. Nothing for silhouettes.
void plan_rays(const simulate::SamplingCheck& check, RunPlan& plan);

}  // namespace grainfield::pipelines
