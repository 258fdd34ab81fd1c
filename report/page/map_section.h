#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "report/page/page_content.h"

namespace grainfield::report {

/// The pictures of the runs with their controls: marks, lens, zoom, colour, frame and places to go
/// to. One picture, or two side by side; of more runs with a choice and a gallery. Where runs have
/// particles and no picture, the sentence that says so. The pictures are filled in by the script of
/// the page.
std::string map_html(const PageContent& content);

/// Pictures that are shown side by side.
inline constexpr std::size_t kMostViews = 2;

/// The runs that have pictures, in their order. The first kMostViews are shown when the page opens.
std::vector<std::size_t> runs_with_pictures(const PageContent& content);

}  // namespace grainfield::report
