#include "report/page/space_section.h"

#include <algorithm>
#include <cstddef>
#include <set>

#include <fmt/format.h>

namespace grainfield::report {

namespace {

constexpr const char* reading =
    "<p class=\"reading\">A strip two diameters deep, to scale. Spheres nearer to the lower edge "
    "of "
    "the map stand in front; those behind are paler. Thin lines are the faces of the plates, "
    "as far as they are known. Colours are those of the map, where dashed boxes mark the "
    "strip and the patch below. A click there, or Enter at the lens, moves both.</p>\n";

constexpr const char* turning =
    "<div class=\"note\"><p>A patch of 12 × 12 diameters without perspective. Drag to turn it, or "
    "use the arrow keys; 0 brings the first view back.</p>\n"
    "<p class=\"doubtful\" hidden><span class=\"ring\"></span> height uncertain by more than 0.2 "
    "diameters</p></div>\n";

// As many as the pictures have views: the first two runs with maps.
std::size_t count_views(const PageContent& content) {
    std::set<std::size_t> runs;
    for (const ParticleMap& map : content.maps) runs.insert(map.run);
    return std::min<std::size_t>(2, runs.size());
}

std::string slider(const char* name, const char* words) {
    return fmt::format(
        "<label>{} <input type=\"range\" class=\"{}\" step=\"0.5\" value=\"0\"><output></output>"
        "</label>\n",
        words, name);
}

std::string view_html(const char* kind, const char* label, bool takes_keys) {
    return fmt::format(
        "<figure class=\"{0}-view\" hidden><figcaption class=\"caption\"></figcaption>"
        "<canvas class=\"{0}\" role=\"img\"{1} aria-label=\"{2}\"></canvas>"
        "<p class=\"note state\"></p></figure>\n",
        kind, takes_keys ? " tabindex=\"0\"" : "", label);
}

}  // namespace

bool has_space(const PageContent& content) {
    return std::ranges::any_of(content.maps, &ParticleMap::has_heights);
}

std::string space_html(const PageContent& content) {
    if (!has_space(content)) return "";
    std::string out = "<section class=\"space\"><h2>The layer from the side</h2>\n";
    out += reading;
    out += "<div class=\"controls\">\n" + slider("across", "Strip") +
           slider("along", "Along the strip") + "</div>\n";
    const std::size_t views = count_views(content);
    for (std::size_t v = 0; v < views; ++v) {
        out += view_html("side", "Spheres of a strip from the side", false);
    }
    out += "<div class=\"patches\">\n";
    for (std::size_t v = 0; v < views; ++v) {
        out += view_html("patch",
                         "Spheres of a patch in space: arrow keys turn it, 0 brings the first view "
                         "back",
                         true);
    }
    out += turning;
    return out + "</div></section>\n";
}

}  // namespace grainfield::report
