#pragma once

#include <cstdint>

#include "app/command.h"
#include "simulate/render/renderer.h"
#include "simulate/render/sampling_check.h"

namespace grainfield::app {

/// Adds to `summary` what ray tracing took: rays and samples per pixel of the frame, the share of
/// pixels without any ray, the rays saved against uniform sampling and what that costs in accuracy.
/// For silhouettes the counts are 0 and no line is added.
void add_optics_summary(const simulate::Renderer& renderer, std::int64_t frames,
                        const simulate::SamplingCheck& check, Summary& summary);

}  // namespace grainfield::app
