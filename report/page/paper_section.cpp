#include "report/page/paper_section.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "report/maps/map_svg.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

const char* style_of(const PaperLine& line) {
    if (line.verdict.empty()) return "";
    switch (line.agreement) {
        case Agreement::agrees:
            return " agrees";
        case Agreement::differs:
            return " differs";
        case Agreement::unresolved:
            break;
    }
    return " open";
}

std::string lines_html(const PaperPanel& panel) {
    std::string out = "<p class=\"claim\">" + escape_html("Paper: " + panel.claim) + "</p>\n";
    for (const PaperLine& line : panel.lines) {
        const std::string said =
            line.verdict.empty() ? "" : ". <strong>" + escape_html(line.verdict) + "</strong>";
        out += fmt::format("<p class=\"line{}\">{}{}</p>\n", style_of(line),
                           escape_html(line.words), said);
    }
    if (panel.lines.empty()) {
        out += "<p class=\"line\">The paper gives no number here.</p>\n";
    }
    return out;
}

const char* made_by(Origin origin) {
    switch (origin) {
        case Origin::video:
            return "tracked films";
        case Origin::md:
            return "molecular dynamics, true positions";
        case Origin::rendered:
            return "true positions of rendered films";
        case Origin::points:
            return "points of another program";
        case Origin::field:
            break;
    }
    return "density fields";
}

std::string panel_html(const PaperPanel& panel) {
    std::string out = fmt::format(
        "<figure class=\"panel\" data-panel=\"{0}\"><div class=\"head\"><figcaption><h3>{0}: {1}"
        "</h3></figcaption><div class=\"tools\"></div></div>\n",
        escape_html(panel.number), escape_html(panel.title));
    if (panel.figure) {
        const Figure& figure = *panel.figure;
        out += fmt::format(
            "<div class=\"plot\" id=\"plot-{}\" role=\"img\" aria-label=\"{}\"></div>\n",
            figure.name, escape_html(figure.y.title() + " against " + figure.x.title()));
        out += "<div class=\"legend\"></div>\n";
        if (const std::string open = open_symbols_sentence(figure); !open.empty()) {
            out += "<p class=\"note\">" + escape_html(open) + "</p>\n";
        }
    } else {
        out += "<div class=\"plot empty\"><p>Not drawn: " + escape_html(panel.absent) +
               ".</p></div>\n";
    }
    if (panel.committed) {
        out += fmt::format(
            "<p class=\"line committed\"><strong>Committed results, not of these runs</strong>: "
            "{}. "
            "Here: {}.</p>\n",
            made_by(*panel.committed), escape_html(panel.absent));
    }
    return out + lines_html(panel) + "</figure>\n";
}

std::string map_panel_html(const ParticleMap* map, const std::string& label) {
    std::string out =
        "<figure class=\"panel\" data-panel=\"1b map\"><h3>1b: map of |Q₄|, discs at 85 %</h3>\n";
    if (map == nullptr) {
        return out +
               "<div class=\"plot empty\"><p>Not drawn: no tracked run keeps a frame with "
               "|Q₄|.</p></div></figure>\n";
    }
    ParticleMap bare = *map;
    bare.png.clear();  // the discs alone, as there
    return out + "<div class=\"map\">" + map_svg(bare, label) + "</div></figure>\n";
}

constexpr std::array<std::string_view, 3> rows{"Experiment: films of simulated spheres, tracked",
                                               "Molecular dynamics: a periodic layer",
                                               "Field model: two dimensions, b = 4"};

}  // namespace

const ParticleMap* paper_map(const std::vector<ParticleMap>& maps, std::optional<std::size_t> run) {
    const ParticleMap* found = nullptr;
    for (const ParticleMap& map : maps) {
        if (map.run == run && !map.abs_q4.empty()) found = &map;
    }
    return found;
}

std::string paper_section_html(const std::vector<PaperPanel>& panels, const ParticleMap* map,
                               const std::string& map_label) {
    const auto add = [&](std::string& out, std::string_view number) {
        const auto panel = std::ranges::find(panels, number, &PaperPanel::number);
        if (panel != panels.end()) out += panel_html(*panel);
    };
    std::string out =
        "<section class=\"paper\" aria-label=\"The figures of the paper\">\n"
        "<div class=\"paper-row two\">\n";
    out += map_panel_html(map, map_label);
    add(out, "1b");
    out += "</div>\n";
    constexpr std::string_view letters = "abcdefghi";
    for (std::size_t row = 0; row < rows.size(); ++row) {
        out += "<h2>" + escape_html(rows.at(row)) + "</h2>\n<div class=\"paper-row three\">\n";
        for (std::size_t column = 0; column < 3; ++column) {
            add(out, std::string("2") + letters[3 * row + column]);
        }
        out += "</div>\n";
    }
    out += "<h2>Motion, and other boxes</h2>\n<div class=\"paper-row three\">\n";
    for (const char* number : {"3", "4a", "4b"}) add(out, number);
    return out + "</div></section>\n";
}

}  // namespace grainfield::report
