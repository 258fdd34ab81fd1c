#pragma once

#include <string_view>

namespace grainfield::report {

/// Files that the build copies into the library (CMakeLists.txt), with the SHA-256 of each in hex.
extern const std::string_view plotly_script, plotly_script_sha256;
extern const std::string_view plotly_licence, plotly_licence_sha256;
extern const std::string_view page_script, page_script_sha256;
extern const std::string_view space_script, space_script_sha256;
extern const std::string_view page_style, page_style_sha256;

}  // namespace grainfield::report
