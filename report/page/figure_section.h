#pragma once

#include <string>

#include "report/page/page_content.h"

namespace grainfield::report {

/// The figures of a critical point; empty if there are none. The plots are filled in by the script
/// of the page.
std::string critical_html(const PageContent& content);

/// The other figures that say how to read them; empty if there are none. Those of the paper have a
/// section of their own.
std::string main_curves_html(const PageContent& content);

/// The rest of the figures, and pictures of S(k) by wavevector of the first four runs that have
/// one.
std::string more_curves_html(const PageContent& content);

}  // namespace grainfield::report
