#pragma once

#include <string>
#include <string_view>

#include "report/figures/figure.h"

namespace grainfield::report {

/// Commands that make gnuplot (5.2 or later) draw the figure into the SVG file `svg` and, where one
/// is named, once more into the PDF file `pdf`. Data are inline; every text stands in single quotes
/// and is drawn without markup, so that no name can become a command or formatting.
std::string gnuplot_script(const Figure& figure, const std::string& svg,
                           const std::string& pdf = "");

enum class PlotForm { svg, pdf, png };

/// Commands that draw the figure for print: one column of a journal (8.6 cm), a frame with ticks
/// inwards, no grid, the key below. Of several runs the fits have no entry in it. PNG with 600
/// pixels an inch.
std::string publication_script(const Figure& figure, const std::string& file, PlotForm form);

/// The text as a gnuplot string in single quotes, where a backslash means nothing. Quotes and
/// backquotes become ’: gnuplot 5.4 does not read every doubled quote as one.
std::string gnuplot_string(std::string_view text);

}  // namespace grainfield::report
