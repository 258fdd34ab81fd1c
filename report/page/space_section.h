#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// Whether a map knows how high its particles lie, so that the page shows the layer from the side
/// and needs the script that draws it.
bool has_space(const PageContent& content);

/// The layer from the side: a strip and a patch of the map that each view of the pictures shows.
/// Empty where has_space is false. The pictures are drawn by the second script of the page.
std::string space_html(const PageContent& content);

}  // namespace grainfield::report
