#include "simulate/render/optics.h"

#include "simulate/render/raytrace.h"
#include "simulate/render/silhouette.h"

namespace grainfield::simulate {

std::unique_ptr<Optics> make_optics(const RenderOptions& options, int threads) {
    if (options.optics == OpticsKind::silhouette) {
        return std::make_unique<SilhouetteOptics>(options.silhouette, threads);
    }
    RaytraceOptions raytrace = options.raytrace;
    raytrace.tolerance = sampling_tolerance(options);
    return std::make_unique<RaytraceOptics>(raytrace, threads);
}

}  // namespace grainfield::simulate
