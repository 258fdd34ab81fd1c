#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/figure_hint.h"
#include "report/figures/colours.h"

namespace grainfield::report {

/// One kind of quantity in a figure; every run may have a series of each kind.
struct Kind {
    std::string label;
    Mark mark = Mark::line;
    bool shown = true;       ///< false: on the page only after a click, not in the SVG
    std::string word{};      ///< of the results that its series have; empty: there is none
    bool is_filled = false;  ///< a guide around an area, which the page fills
    bool is_joined = true;   ///< points of Mark::line; false: alone, with their error bars
};

/// Where a figure belongs.
enum class FigureGroup {
    page,               ///< among the others
    critical_point,     ///< with what is measured of a critical point
    critical_distance,  ///< the same, against the distance to it
    paper,              ///< a panel of the paper
};

struct Series {
    std::size_t run = 0;   ///< index into Figure::runs; of no meaning for guides
    std::size_t kind = 0;  ///< index into Figure::kinds
    std::vector<double> x, y;
    std::vector<double> error;  ///< standard error of y, NaN where unknown; empty: it has none
};

/// A plot, described once: the page (Plotly), the SVG (gnuplot) and the CSV are made from this.
struct Figure {
    struct Absence {
        std::size_t run = 0;
        std::string reason;
    };

    std::string name;   ///< file name of SVG and CSV, id on the page
    std::string title;  ///< for people
    FigureGroup group = FigureGroup::page;
    std::string note;     ///< what to know when reading it; may be empty
    std::string reading;  ///< what it is, how to read it, what is usual; may be empty
    Axis x, y;
    bool may_be_linear = false;  ///< a button switches the logarithmic axes to linear ones
    std::vector<std::string> runs;
    std::vector<std::string> origins;  ///< one a run, for switching all of an origin; may be empty
    std::vector<Kind> kinds;
    std::vector<Series> series;
    std::vector<Absence> absent;  ///< runs without this curve, and why

    bool has_data() const;  ///< whether any run has a series
};

/// Points whose error is not known, of a series that has a column of errors. They are drawn as open
/// symbols: without a bar they would look precise. Of a series of points alone; of any other none.
std::vector<std::size_t> points_without_error(const Figure& figure, const Series& series);

/// "Open symbols: the error is not known.", where a shown series has such points; else empty.
std::string open_symbols_sentence(const Figure& figure);

/// How a series looks, wherever it is drawn. One run: colour by kind; several: colour by run,
/// symbols by run, dashes by kind; symbols of points without lines by both, as are dashes of the
/// outlines of histograms, which have no symbols. Guides are grey.
struct Style {
    Colour colour;
    std::size_t symbol = 0;  ///< 0 circle, 1 square, 2 diamond, 3 triangle
    std::size_t dash = 0;    ///< 0 solid, 1 dashed, 2 dotted, 3 dash-dotted
};
Style style_of(const Figure& figure, std::size_t run, std::size_t kind);

/// "Γ = 4.5, solid"; only the run or only the kind where the other says nothing.
std::string series_label(const Figure& figure, const Series& series);

/// The smallest range that holds all finite y (x) of the shown series; on a logarithmic axis only
/// positive values count. {0, 0} if there is none.
std::array<double, 2> extent(const Figure& figure, const Axis& axis,
                             std::vector<double> Series::*values);

/// Adds a guide through these points.
void add_guide(Figure& figure, std::string label, std::vector<double> x, std::vector<double> y);

/// Adds a filled guide from x = low to high, as high as the data; of one point alone a third high.
void add_band(Figure& figure, std::string label, double low, double high);

/// Adds the guide y = y0 (x/x0)^exponent between x0 and x1.
void add_power_law(Figure& figure, std::string label, double exponent, double x0, double y0,
                   double x1);

}  // namespace grainfield::report
