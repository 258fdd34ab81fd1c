#pragma once

#include <memory>
#include <vector>

#include "simulate/render/optics/optics.h"

namespace grainfield::simulate {

/// Every optics that the program knows, with default options; the first is the default.
std::vector<std::unique_ptr<OpticsKind>> all_optics();

}  // namespace grainfield::simulate
