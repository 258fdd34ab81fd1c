#include "app/optics_summary.h"

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

void add_optics_summary(const pipelines::OpticsUse& use, Summary& summary) {
    summary.facts["rays_per_pixel"] = use.rays_per_pixel;
    summary.facts["samples_per_pixel"] = use.samples_per_pixel;
    summary.facts["settled_pixels"] = use.settled_pixels;
    summary.facts["rays_saved"] = use.rays_saved;
    add_flights(use.flights, summary);
    if (use.rays_per_pixel <= 0) return;
    summary.text += fmt::format(
        "  {:.1f} rays a pixel of the frame, {:.0f} % fewer than by uniform sampling; none in "
        "{:.0f} % of the pixels\n",
        use.rays_per_pixel, 100 * use.rays_saved, 100 * use.settled_pixels);
    const simulate::SamplingCheck& check = use.check;
    if (check.size == 0) return;
    summary.facts["sampling_difference"] = check.difference;
    summary.facts["camera_noise"] = check.noise;
    summary.text += fmt::format(
        "  differs from uniform sampling by {:.2f} % of the bright field, camera noise {:.2f} % "
        "(RMS, {} px in the middle)\n",
        100 * check.difference, 100 * check.noise, check.size);
}

}  // namespace grainfield::app
