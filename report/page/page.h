#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// The whole HTML page, self-contained: styles, scripts (plotly.js with its licence) and data are
/// inlined, a content security policy allows these scripts by their hash, data: images and nothing
/// else. Pictures of the runs after the first two follow the scripts, so that what is in sight does
/// not wait until they are read. All text of users is escaped; the same content gives the same
/// bytes.
std::string page_html(const PageContent& content);

}  // namespace grainfield::report
