// In the place of mirror_cell.cpp where the build has no Embree: everything but tracing rays works.
#include "core/errors.h"
#include "simulate/render/optics/mirror_cell.h"

namespace grainfield::simulate {

EmbreeDevice::EmbreeDevice() : handle_(nullptr) {
    throw OptionError({.problem = "this grainfield cannot trace rays",
                       .actual = "it was built without Embree (GRAINFIELD_EMBREE=OFF)",
                       .expected = "a build with Embree 3",
                       .suggestion = "use silhouettes (optics = \"silhouette\")"});
}

EmbreeDevice::~EmbreeDevice() {
    handle_ = nullptr;
}

// Without a device there is no cell.
MirrorCell::MirrorCell(const EmbreeDevice& /*device*/, std::span<const SphereScene> instants,
                       Vec2 middle, const RaytraceOptions& options)
    : instants_(instants),
      options_(options),
      middle_(middle),
      panel_(0),
      low_(0),
      high_(0),
      has_glass_(false),
      clear_(0) {
    throw OptionError("this grainfield was built without Embree");
}

MirrorCell::~MirrorCell() = default;

double MirrorCell::panel(Vec3 /*origin*/, Vec3 /*direction*/) const {
    return 0;
}

MirrorCell::Seen MirrorCell::look(const LightPath& /*ray*/, std::int64_t& /*rays*/) const {
    return {};
}

}  // namespace grainfield::simulate
