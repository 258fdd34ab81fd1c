#pragma once

#include <string_view>

namespace grainfield::tracking {

/// general_correction.txt, which the build copies into the library (CMakeLists.txt).
extern const std::string_view general_correction_text;

}  // namespace grainfield::tracking
