#include "report/figures/figure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace grainfield::report {

bool Figure::has_data() const {
    return std::ranges::any_of(series,
                               [&](const Series& s) { return kinds[s.kind].mark != Mark::guide; });
}

std::vector<std::size_t> points_without_error(const Figure& figure, const Series& series) {
    const auto is_known = [](double error) { return std::isfinite(error) && error > 0; };
    std::vector<std::size_t> open;
    if (figure.kinds[series.kind].mark != Mark::line) return open;
    for (std::size_t i = 0; i < series.error.size(); ++i) {
        if (!is_known(series.error[i])) open.push_back(i);
    }
    return open;
}

std::string open_symbols_sentence(const Figure& figure) {
    const auto is_drawn = [&](const Series& series, std::size_t i) {
        return figure.y.scale == Scale::linear || series.y[i] > 0;
    };
    const bool has_some = std::ranges::any_of(figure.series, [&](const Series& series) {
        return figure.kinds[series.kind].shown &&
               std::ranges::any_of(points_without_error(figure, series),
                                   [&](std::size_t i) { return is_drawn(series, i); });
    });
    return has_some ? "Open symbols: the error is not known." : "";
}

Style style_of(const Figure& figure, std::size_t run, std::size_t kind) {
    const auto is_guide = [](const Kind& k) { return k.mark == Mark::guide; };
    const auto first = figure.kinds.begin();
    const auto here = first + static_cast<std::ptrdiff_t>(kind);
    const auto guides_before = static_cast<std::size_t>(std::count_if(first, here, is_guide));
    if (is_guide(*here)) return {{0x66, 0x66, 0x66}, 0, 1 + guides_before % 3};
    const std::size_t place = kind - guides_before;
    if (figure.runs.size() > 1) {
        // Without colour the symbols tell runs apart, of a histogram the dashes.
        const bool is_outline = here->mark == Mark::steps;
        return {distinct_colour(run, figure.runs.size()), (run + (here->is_joined ? 0 : place)) % 4,
                (place + (is_outline ? run : 0)) % 4};
    }
    const auto kinds = static_cast<std::size_t>(figure.kinds.end() - first -
                                                std::ranges::count_if(figure.kinds, is_guide));
    return {distinct_colour(place, kinds), place % 4, place % 4};
}

std::string series_label(const Figure& figure, const Series& series) {
    const Kind& kind = figure.kinds[series.kind];
    if (kind.mark == Mark::guide || figure.runs.size() == 1) return kind.label;
    const auto shown = std::ranges::count_if(
        figure.kinds, [](const Kind& k) { return k.mark != Mark::guide && k.shown; });
    const std::string& run = figure.runs[series.run];
    return shown == 1 && kind.shown ? run : run + ", " + kind.label;
}

std::array<double, 2> extent(const Figure& figure, const Axis& axis,
                             std::vector<double> Series::*values) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Series& series : figure.series) {
        if (!figure.kinds[series.kind].shown) continue;
        for (double value : series.*values) {
            if (!std::isfinite(value) || (axis.scale == Scale::log && value <= 0)) continue;
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    if (low > high) return {0, 0};
    if (axis.scale == Scale::linear && axis.from_zero) low = std::min(low, 0.0);
    return {low, high};
}

void add_guide(Figure& figure, std::string label, std::vector<double> x, std::vector<double> y) {
    Series guide;
    guide.kind = figure.kinds.size();
    guide.x = std::move(x);
    guide.y = std::move(y);
    figure.kinds.push_back({std::move(label), Mark::guide, true});
    figure.series.push_back(std::move(guide));
}

void add_band(Figure& figure, std::string label, double low, double high) {
    auto [bottom, top] = extent(figure, figure.y, &Series::y);
    if (!(top > bottom)) top = bottom + 1.0 / 3;
    add_guide(figure, std::move(label), {low, high, high, low, low},
              {bottom, bottom, top, top, bottom});
    figure.kinds.back().is_filled = true;
}

void add_power_law(Figure& figure, std::string label, double exponent, double x0, double y0,
                   double x1) {
    // Enough points for a smooth curve on linear axes too.
    constexpr int pieces = 40;
    Series guide;
    guide.kind = figure.kinds.size();
    for (int i = 0; i <= pieces; ++i) {
        const double x = x0 * std::pow(x1 / x0, static_cast<double>(i) / pieces);
        guide.x.push_back(x);
        guide.y.push_back(y0 * std::pow(x / x0, exponent));
    }
    figure.kinds.push_back({std::move(label), Mark::guide, true});
    figure.series.push_back(std::move(guide));
}

}  // namespace grainfield::report
