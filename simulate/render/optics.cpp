#include "simulate/render/optics.h"

#include "core/errors.h"
#include "simulate/render/silhouette.h"

namespace grainfield::simulate {

std::unique_ptr<Optics> make_optics(const RenderOptions& options, int threads) {
    if (options.optics == OpticsKind::silhouette) {
        return std::make_unique<SilhouetteOptics>(options.silhouette, threads);
    }
    throw OptionError("optics: ray tracing is not built in.");
}

}  // namespace grainfield::simulate
