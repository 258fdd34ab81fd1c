#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// A paragraph of links to the SVG, PDF and CSV of this name; to those that exist, empty if none.
std::string file_links(const PageContent& content, const std::string& name);

}  // namespace grainfield::report
