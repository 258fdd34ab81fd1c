#include "app/optics_summary.h"

#include <algorithm>

#include <fmt/format.h>

namespace grainfield::app {

void add_optics_summary(const simulate::Renderer& renderer, std::int64_t frames,
                        const simulate::SamplingCheck& check, Summary& summary) {
    const simulate::OpticsCost cost = renderer.cost();
    const double pixels = std::max(
        1.0, static_cast<double>(frames) * renderer.view().width() * renderer.view().height());
    const double saved = cost.uniform_rays > 0 ? 1 - cost.rays / cost.uniform_rays : 0;
    const double settled = cost.settled / std::max(cost.pixels, 1.0);
    summary.facts["rays_per_pixel"] = cost.rays / pixels;
    summary.facts["samples_per_pixel"] = cost.samples / pixels;
    summary.facts["settled_pixels"] = settled;
    summary.facts["rays_saved"] = saved;
    if (cost.rays <= 0) return;
    summary.text += fmt::format(
        "  {:.1f} rays a pixel of the frame, {:.0f} % fewer than by uniform sampling; none in "
        "{:.0f} % of the pixels\n",
        cost.rays / pixels, 100 * saved, 100 * settled);
    if (check.size == 0) return;
    summary.facts["sampling_difference"] = check.difference;
    summary.facts["camera_noise"] = check.noise;
    summary.text += fmt::format(
        "  differs from uniform sampling by {:.2f} % of the bright field, camera noise {:.2f} % "
        "(RMS, {} px in the middle)\n",
        100 * check.difference, 100 * check.noise, check.size);
}

}  // namespace grainfield::app
