#include "report/figures/plotly_figure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/text.h"

namespace grainfield::report {

namespace {

using nlohmann::json;

constexpr std::array<const char*, 4> symbols{"circle", "square", "diamond", "triangle-up"};
constexpr std::array<const char*, 4> glyphs{"●", "■", "◆", "▲"};  // the symbols in a legend
constexpr std::array<const char*, 4> dashes{"solid", "dash", "dot", "dashdot"};

// Six significant digits keep the page small.
json numbers(const std::vector<double>& values) {
    json list = json::array();
    for (double value : values) {
        if (std::isfinite(value)) {
            list.push_back(std::stod(fmt::format("{:.6g}", value)));
        } else {
            list.push_back(nullptr);
        }
    }
    return list;
}

// The outline of a histogram: from zero at the left edge of the first bin to zero at the right edge
// of the last one.
void add_outline(json& trace, const Series& series) {
    const std::size_t n = series.x.size();
    const double width =
        n > 1 ? (series.x.back() - series.x.front()) / static_cast<double>(n - 1) : 1;
    std::vector<double> edge{series.x.front() - width / 2};
    std::vector<double> height{0};
    for (std::size_t i = 0; i < n; ++i) {
        edge.push_back(series.x[i] - width / 2);
        height.push_back(series.y[i]);
    }
    edge.push_back(series.x.back() + width / 2);
    height.push_back(0);
    trace["x"] = numbers(edge);
    trace["y"] = numbers(height);
    trace["mode"] = "lines";
    trace["line"]["shape"] = "hv";
    trace["line"]["width"] = 2;
}

json trace(const Figure& figure, const Series& series) {
    const Kind& kind = figure.kinds[series.kind];
    const Style style = style_of(figure, series.run, series.kind);
    const std::string colour = hex(style.colour);
    json t{{"type", "scatter"},
           {"x", numbers(series.x)},
           {"y", numbers(series.y)},
           {"name", escape_html(series_label(figure, series))},
           {"visible", kind.shown},
           {"meta", {{"run", series.run}, {"kind", series.kind}}},
           {"line", {{"color", colour}, {"dash", dashes[style.dash]}, {"width", 1.4}}},
           {"hovertemplate", escape_html(figure.x.name) + " = %{x:.4g}<br>" +
                                 escape_html(figure.y.name) + " = %{y:.4g}"}};
    if (kind.mark == Mark::guide) {
        t["mode"] = "lines";
        t["hoverinfo"] = "skip";
        t.erase("hovertemplate");
        if (kind.is_filled) {
            t["fill"] = "toself";
            t["fillcolor"] = "rgba(102,102,102,0.18)";
        }
        return t;
    }
    if (kind.mark == Mark::curve) {
        t["mode"] = "lines";
        t["line"]["width"] = 2.4;
        return t;
    }
    if (kind.mark == Mark::steps) {
        add_outline(t, series);
        if (figure.runs.size() == 1) t["fill"] = "tozeroy";
        return t;
    }
    t["mode"] = kind.is_joined ? "lines+markers" : "markers";
    // A crowd of points gets small marks and no line through the noise.
    const bool crowded = series.x.size() > 120;
    if (crowded) t["line"]["width"] = 0.7;
    t["marker"] = {{"color", colour}, {"symbol", symbols[style.symbol]}, {"size", crowded ? 4 : 6}};
    if (const auto open = points_without_error(figure, series); !open.empty()) {
        json each(series.x.size(), symbols[style.symbol]);
        for (const std::size_t i : open) each[i] = fmt::format("{}-open", symbols[style.symbol]);
        t["marker"]["symbol"] = each;
    }
    const bool has_errors =
        std::ranges::any_of(series.error, [](double e) { return std::isfinite(e) && e > 0; });
    if (has_errors) {
        t["error_y"] = {{"type", "data"},
                        {"array", numbers(series.error)},
                        {"color", colour},
                        {"thickness", 1},
                        {"width", crowded ? 0 : 2}};
    }
    return t;
}

json axis(const Axis& axis) {
    json a{{"title", {{"text", escape_html(axis.title())}, {"standoff", 8}}},
           {"type", axis.scale == Scale::log ? "log" : "linear"},
           {"exponentformat", "power"},
           {"showline", true},
           {"linecolor", "#444"},
           {"ticks", "outside"},
           {"tickcolor", "#444"},
           {"gridcolor", "#ececec"},
           {"zeroline", false},
           {"automargin", true}};
    a["tickfont"] = {{"size", 12}};
    if (axis.scale == Scale::linear) a["tickformat"] = ",.6~g";
    if (axis.from_zero) a["rangemode"] = "tozero";
    if (axis.scale == Scale::log) a["minor"] = {{"ticks", "outside"}, {"ticklen", 3}};
    return a;
}

}  // namespace

std::string plotly_json(const Figure& figure) {
    json kinds = json::array();
    for (std::size_t k = 0; k < figure.kinds.size(); ++k) {
        const Style style = style_of(figure, 0, k);
        const bool is_guide = figure.kinds[k].mark == Mark::guide;
        const bool coloured = is_guide || figure.runs.size() == 1;
        kinds.push_back({{"label", clean_text(figure.kinds[k].label)},
                         {"colour", coloured ? hex(style.colour) : "#333333"},
                         {"dash", dashes[style.dash]},
                         {"guide", is_guide},
                         {"shown", figure.kinds[k].shown}});
        if (!figure.kinds[k].is_joined) kinds.back()["symbol"] = glyphs.at(style.symbol);
    }
    json runs = json::array();
    for (std::size_t r = 0; r < figure.runs.size(); ++r) {
        runs.push_back({{"label", clean_text(figure.runs[r])},
                        {"colour", hex(distinct_colour(r, figure.runs.size()))},
                        {"symbol", glyphs[r % glyphs.size()]}});
    }
    json groups = json::array();
    for (std::size_t r = 0; r < figure.origins.size(); ++r) {
        const std::string origin = clean_text(figure.origins[r]);
        const auto known = std::ranges::find_if(
            groups, [&](const json& group) { return group["label"] == origin; });
        if (known == groups.end()) {
            groups.push_back({{"label", origin}, {"runs", json::array({r})}});
        } else {
            (*known)["runs"].push_back(r);
        }
    }
    json traces = json::array();
    for (const Series& series : figure.series) traces.push_back(trace(figure, series));
    const json whole{{"name", figure.name},
                     {"toggle", figure.may_be_linear},
                     {"runs", runs},
                     {"kinds", kinds},
                     {"groups", groups},
                     {"traces", traces},
                     {"layout", {{"xaxis", axis(figure.x)}, {"yaxis", axis(figure.y)}}}};
    return escape_json_for_script(whole.dump());
}

}  // namespace grainfield::report
