#include "tracking/track_plan.h"

#include <fmt/format.h>

#include "tracking/warm_start.h"

namespace grainfield::tracking {

void plan_frames(const ImageModel& model, const TrackOptions& options, std::int64_t count,
                 RunPlan& plan) {
    plan.run("detect", "χ² map, then likelihood gain of the residual until nothing changes");
    plan.run("refine", fmt::format("joint least squares on the {}{}", model.overlap->title(),
                                   model.correction.is_zero() ? "" : " of the learned profile"));
    if (count < 2) {
        plan.skip("link", "one frame", "identities");
    } else {
        if (options.part) {
            plan.skip("link", "a part of the film: 'grainfield link' joins parts", "identities");
        } else {
            plan.run("link", "least squared steps, optimal where spheres compete");
        }
        plan.run("warm start",
                 fmt::format("frames begin, two at a time, with the spheres of the frame before "
                             "them while these move less than {:.2g} D",
                             kWarmStep));
    }
}

void plan_camera(const CameraMap& camera, const Box& box, int width, int height, RunPlan& plan) {
    const double all = static_cast<double>(width) * height;
    plan.run("camera",
             fmt::format("positions corrected for lens and tilt; box of {:.1f} x {:.1f} px{}, "
                         "{:.1f} % of the frame",
                         box.length.x, box.length.y,
                         camera.camera().cell ? " between the walls" : "", 100 * box.area() / all));
}

void plan_heights(const TrackOptions& options, RunPlan& plan) {
    if (options.synthesis) {
        plan.run("synthesis",
                 fmt::format("mirror spheres rendered and fitted to each frame in x, y and z; "
                             "plates {:.4g} a apart",
                             options.synthesis_options.height));
        plan.run("layers", "the side of the middle of the cell on which synthesis has a sphere");
        return;
    }
    if (options.layers.height) {
        plan.run("layers", "overlaps in projection, up to turning each cluster of spheres over");
    } else {
        plan.skip("layers", "the height of the cell is not known (layers.height)",
                  "layer labels, rejection of impossible spheres");
    }
}

}  // namespace grainfield::tracking
