#include "simulate/render/sampling_check.h"

#include <algorithm>
#include <cmath>

#include "core/run_plan.h"
#include "simulate/render/renderer.h"

namespace grainfield::simulate {

namespace {

constexpr int patch = 64;  // [px]

/// The middle of the frame by an even, noiseless camera of 16 bits.
RenderOptions patch_options(const RenderOptions& options, const View& view) {
    RenderOptions o = options;
    o.camera = CameraKind::ideal;
    o.view.width = std::min(patch, view.width());
    o.view.height = std::min(patch, view.height());
    o.view.scale = view.scale();
    o.view.centre_x = view.centre().x;
    o.view.centre_y = view.centre().y;
    o.light.level = 0.9;
    o.sensor.bits = 16;
    o.sensor.offset = 0;
    o.sensor.gain.reset();
    return o;
}

}  // namespace

SamplingCheck check_sampling(const RenderOptions& options, const View& view,
                             const TrajectoryInfo& info, const SnapshotSeries& series,
                             std::uint64_t seed, int threads) {
    SamplingCheck check;
    // The patch has a camera of its own; the savings stay those that the given one permits.
    RenderOptions adaptive = patch_options(options, view);
    adaptive.optics.chosen().settle(bright_field_noise(options));
    RenderOptions uniform = adaptive;
    if (!uniform.optics.chosen().become_reference()) return check;
    RunPlan unused;
    Renderer a(adaptive, info, series.snapshot().box, seed, threads, unused);
    Renderer b(uniform, info, series.snapshot().box, seed, threads, unused);
    const Image seen = a.render(series, 0).frame.image;
    const Image reference = b.render(series, 0).frame.image;
    const double bright = b.camera().mean_counts(1);
    const Camera camera(options, a.view(), seed, threads);
    const double span = 10 * (camera.mean_counts(0.1) - camera.mean_counts(0));
    double squares = 0;
    double variance = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const double there = static_cast<double>(reference.pixels()[i]) / bright;
        const double d = static_cast<double>(seen.pixels()[i]) / bright - there;
        squares += d * d;
        const double stray = options.effective().light.stray;
        variance += camera.variance_counts((1 - stray) * there + stray);
    }
    const auto n = static_cast<double>(seen.size());
    check.size = a.view().width();
    check.difference = std::sqrt(squares / n);
    check.noise = std::sqrt(variance / n) / span;
    const OpticsCost cost = a.cost();
    check.rays = cost.rays / n;
    check.saved = cost.uniform_rays > 0 ? 1 - cost.rays / cost.uniform_rays : 0;
    return check;
}

}  // namespace grainfield::simulate
