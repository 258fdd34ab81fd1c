#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// The pictures of the runs with their controls: marks, lens, zoom, colour, frame and places to go
/// to. One picture, or two side by side; of more runs with a choice and a gallery. Where runs have
/// particles and no picture, the sentence that says so. The pictures are filled in by the script of
/// the page.
std::string map_html(const PageContent& content);

}  // namespace grainfield::report
