#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// The head of the page: its title, what it is of, and what came of it in one sentence, with the
/// number of warnings. Of several runs the list with their colours besides.
std::string header_html(const PageContent& content);

}  // namespace grainfield::report
