#include "simulate/render/optics/optics_list.h"

#include "simulate/render/optics/raytrace.h"
#include "simulate/render/optics/silhouette.h"

namespace grainfield::simulate {

std::vector<std::unique_ptr<OpticsKind>> all_optics() {
    std::vector<std::unique_ptr<OpticsKind>> list;
    list.push_back(std::make_unique<Silhouette>());
    list.push_back(std::make_unique<Raytrace>());
    return list;
}

}  // namespace grainfield::simulate
