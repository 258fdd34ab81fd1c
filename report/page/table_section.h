#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// All tables but that of differences; empty if there are none.
std::string tables_html(const PageContent& content);

/// The table of differences of a comparison, which comes after the curves; empty if there is none.
std::string differences_html(const PageContent& content);

/// All key numbers with their errors, folded.
std::string numbers_html(const PageContent& content);

}  // namespace grainfield::report
