#include "app/optics_summary.h"

#include <algorithm>

#include <fmt/format.h>

namespace grainfield::app {

namespace {

void add_flights(const simulate::FlightTally& flights, Summary& summary) {
    const auto all = static_cast<double>(flights.free + flights.turned + flights.several);
    summary.facts["flights"] = {{"free", flights.free},
                                {"one_collision", flights.turned},
                                {"several_collisions", flights.several}};
    if (all <= 0) return;
    summary.text += fmt::format(
        "  flights between snapshots: {:.1f} % without a collision, {:.1f} % followed through one, "
        "{:.1f} % with several\n",
        100 * static_cast<double>(flights.free) / all,
        100 * static_cast<double>(flights.turned) / all,
        100 * static_cast<double>(flights.several) / all);
}

}  // namespace

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
    add_flights(renderer.flights(), summary);
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

void explain_rays(const simulate::SamplingCheck& check, RunPlan& plan) {
    if (check.size == 0) return;
    plan.run("rays",
             fmt::format("{:.1f} a pixel, {:.0f} % fewer than by uniform sampling, on {} px "
                         "in the middle of the first frame",
                         check.rays, 100 * check.saved, check.size));
    plan.run("sampling error",
             fmt::format("{:.2f} % of the bright field there, camera noise {:.2f} %",
                         100 * check.difference, 100 * check.noise));
}

}  // namespace grainfield::app
