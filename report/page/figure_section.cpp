#include "report/page/figure_section.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/maps/spectrum_map.h"
#include "report/page/definitions.h"
#include "report/page/file_links.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

// Runs without this curve, those with one reason together; a long list is folded.
std::string absent_html(const Figure& figure) {
    if (figure.absent.empty()) return "";
    std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
    for (const Figure::Absence& absence : figure.absent) {
        auto known = std::ranges::find_if(
            reasons, [&](const auto& entry) { return entry.first == absence.reason; });
        if (known == reasons.end()) {
            reasons.push_back({absence.reason, {}});
            known = reasons.end() - 1;
        }
        known->second.push_back(figure.runs[absence.run]);
    }
    std::string list = "<ul class=\"absent\">";
    for (const auto& [reason, runs] : reasons) {
        std::string who;
        for (const std::string& run : runs) who.append(who.empty() ? "" : "; ").append(run);
        who.append(": ").append(reason);
        list += fmt::format("<li>Without {}</li>", escape_html(who));
    }
    list += "</ul>\n";
    constexpr std::size_t most_open = 3;
    if (figure.absent.size() <= most_open) return list;
    return fmt::format(
        "<details class=\"absent\"><summary>{} runs are not here</summary>{}</details>\n",
        figure.absent.size(), list);
}

bool is_of_critical_point(const Figure& figure) {
    return figure.group == FigureGroup::critical_point ||
           figure.group == FigureGroup::critical_distance;
}

// Of a figure without data nothing: what is missing stands in one line above.
std::string figure_html(const PageContent& content, const Figure& figure) {
    if (!figure.has_data()) return "";
    std::string out =
        fmt::format("<figure id=\"figure-{0}\"><div class=\"head\"><figcaption><h3>{1}</h3>",
                    figure.name, with_definitions(figure.title));
    if (!figure.reading.empty()) {
        out += "<p class=\"reading\">" + with_definitions(figure.reading) + "</p>";
    }
    const std::string note =
        figure.note.empty() ? "" : "<p class=\"note\">" + escape_html(figure.note) + "</p>";
    // What a critical point comes to stands under its picture.
    const bool is_below = is_of_critical_point(figure);
    if (!is_below) out += note;
    out += fmt::format(
        "</figcaption><div class=\"tools\"></div></div>\n<div class=\"legend\"></div>\n"
        "<div class=\"plot\" id=\"plot-{}\" role=\"img\" aria-label=\"{}\"></div>\n",
        figure.name, escape_html(figure.y.title() + " against " + figure.x.title()));
    if (is_below) out += note;
    out += absent_html(figure);
    return out + file_links(content, figure.name) + "</figure>\n";
}

// Pictures of S(k) by wavevector, of the first runs that have one.
std::string spectrum_maps_html(const PageContent& content) {
    constexpr std::size_t most = 4;
    std::string out;
    std::size_t drawn = 0;
    for (std::size_t r = 0; r < content.runs.size() && drawn < most; ++r) {
        const std::string svg = spectrum_map_svg(content.runs[r], content.labels[r]);
        if (svg.empty()) continue;
        ++drawn;
        out +=
            "<figure class=\"spectrum-map\"><div class=\"head\"><figcaption><h3>S(k) by wavevector";
        if (content.runs.size() > 1) out += ", " + escape_html(content.labels[r]);
        out += "</h3></figcaption></div>\n" + svg + "</figure>\n";
    }
    return out;
}

bool is_of_paper(const Figure& figure) {
    return figure.group == FigureGroup::paper;
}

enum class Reading { said, not_said };

// The figures that say how to read them, or those that do not.
std::string curves_html(const PageContent& content, Reading reading) {
    std::string out;
    for (const Figure& figure : content.figures) {
        if (is_of_critical_point(figure) || is_of_paper(figure)) continue;
        if (figure.reading.empty() == (reading == Reading::not_said))
            out += figure_html(content, figure);
    }
    return out;
}

}  // namespace

std::string critical_html(const PageContent& content) {
    std::string out;
    for (const Figure& figure : content.figures) {
        if (is_of_critical_point(figure)) out += figure_html(content, figure);
    }
    if (out.empty()) return "";
    return "<section class=\"figures\" aria-label=\"Critical point\">\n" + out + "</section>\n";
}

std::string main_curves_html(const PageContent& content) {
    const std::string curves = curves_html(content, Reading::said);
    if (curves.empty()) return "";
    return "<section class=\"figures\" aria-label=\"Main curves\">\n" + curves + "</section>\n";
}

std::string more_curves_html(const PageContent& content) {
    const std::string curves =
        curves_html(content, Reading::not_said) + spectrum_maps_html(content);
    if (curves.empty()) return "";
    return std::string(content.key_numbers ? "<h2>More curves</h2>\n" : "") +
           "<section class=\"figures\">\n" + curves + "</section>\n";
}

}  // namespace grainfield::report
