#include "pipelines/render/optics_use.h"

#include <algorithm>

#include <fmt/format.h>

namespace grainfield::pipelines {

OpticsUse optics_use(const simulate::Renderer& renderer, std::int64_t frames,
                     const simulate::SamplingCheck& check) {
    const simulate::OpticsCost cost = renderer.cost();
    const double pixels = std::max(
        1.0, static_cast<double>(frames) * renderer.view().width() * renderer.view().height());
    return {.rays_per_pixel = cost.rays / pixels,
            .samples_per_pixel = cost.samples / pixels,
            .settled_pixels = cost.settled / std::max(cost.pixels, 1.0),
            .rays_saved = cost.uniform_rays > 0 ? 1 - cost.rays / cost.uniform_rays : 0,
            .flights = renderer.flights(),
            .check = check};
}

void plan_rays(const simulate::SamplingCheck& check, RunPlan& plan) {
    if (check.size == 0) return;
    plan.run("rays",
             fmt::format("{:.1f} a pixel, {:.0f} % fewer than by uniform sampling, on {} px "
                         "in the middle of the first frame",
                         check.rays, 100 * check.saved, check.size));
    plan.run("sampling error",
             fmt::format("{:.2f} % of the bright field there, camera noise {:.2f} %",
                         100 * check.difference, 100 * check.noise));
}

}  // namespace grainfield::pipelines
