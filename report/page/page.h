#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// The whole HTML page, self-contained: styles, scripts (plotly.js with its licence) and data are
/// inlined, a content security policy allows these two scripts by their hash, data: images and
/// nothing else. All text of users is escaped; the same content gives the same bytes.
std::string page_html(const PageContent& content);

}  // namespace grainfield::report
