#include "core/figure_hint.h"

namespace grainfield {

std::string Axis::title() const {
    return unit.empty() ? label : label + " [" + unit + "]";
}

}  // namespace grainfield
