#include "report/page/map_section.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "report/figures/colours.h"
#include "report/page/file_links.h"
#include "report/page/space_section.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

std::string colour_bar(const std::string& order) {
    std::string out = "<span class=\"colour-bar\"><span class=\"order\">" + order +
                      "</span> 0 <i style=\"background:linear-gradient(90deg";
    for (int i = 0; i <= 10; ++i) out.append(",").append(hex(viridis(i / 10.0)));
    return out + ")\"></i> 1</span>\n";
}

// What the maps show: frames of a camera with what was found in them, else particles, else fields.
const char* map_heading(const std::vector<ParticleMap>& maps) {
    const auto is_field = [](const ParticleMap& map) { return map.is_field; };
    const auto is_frame = [&](const ParticleMap& map) {
        return !is_field(map) && !map.png.empty();
    };
    if (std::ranges::any_of(maps, is_frame)) return "Frame with detections";
    return !maps.empty() && std::ranges::all_of(maps, is_field) ? "Fields" : "Positions";
}

std::string why_marked(const Place& place) {
    return place.words.empty() ? fmt::format("residual {:.2f}", place.residual)
                               : clean_text(place.words);
}

// The places of all maps of the first run, worst first within a map, as buttons that go there.
std::string places_html(const PageContent& content) {
    constexpr std::size_t most = 12;
    std::string buttons;
    std::size_t count = 0;
    std::size_t all = 0;
    for (std::size_t m = 0; m < content.maps.size(); ++m) {
        const ParticleMap& map = content.maps[m];
        all += map.places.size();
        for (std::size_t p = 0; p < map.places.size() && count < most; ++p) {
            buttons += fmt::format(
                "<button type=\"button\" class=\"place\" value=\"{} {}\" title=\"{}\">{}</button>",
                m, p,
                escape_html(fmt::format("{}: {} at x = {:.0f}, y = {:.0f} {}",
                                        content.labels[map.run], why_marked(map.places[p]),
                                        map.places[p].position.x, map.places[p].position.y,
                                        map.unit)),
                ++count);
        }
    }
    if (buttons.empty()) return "";
    const std::string shown = all > count ? fmt::format(" (the first {} of {})", count, all) : "";
    return "<p class=\"places\">" + escape_html(content.places_title) + shown + ": " + buttons +
           "</p>\n";
}

// One picture with its axes; with a choice of runs where there are more than the page shows.
std::string view_html(const PageContent& content, const std::vector<std::size_t>& runs,
                      std::size_t shown, bool has_choice) {
    std::string options;
    for (const std::size_t r : runs) {
        options += fmt::format("<option value=\"{}\"{}>{}</option>", r,
                               r == shown ? " selected" : "", escape_html(content.labels[r]));
    }
    std::string head =
        fmt::format("<label hidden>Run <select class=\"pick-run\">{}</select></label>", options);
    if (has_choice) {
        head = fmt::format("<label>Run <select class=\"pick-run\">{}</select></label>", options);
    } else if (runs.size() > 1) {
        head += "<strong>" + escape_html(content.labels[shown]) + "</strong>";
    }
    return "<div class=\"view\"><p class=\"view-head\">" + head +
           " <span class=\"caption\"></span></p>\n"
           "<div class=\"stage\" tabindex=\"0\" role=\"group\" aria-label=\"Picture of " +
           escape_html(content.labels[shown]) +
           ": arrow keys move the lens, plus and minus zoom, 0 shows all" +
           (has_space(content) ? ", Enter shows the place from the side" : "") +
           "\"><canvas></canvas>"
           "<div class=\"plot\" role=\"img\" aria-label=\"Particles\"></div>"
           "<canvas class=\"lens\" hidden></canvas></div></div>\n";
}

// Two pictures of one kind open on one scale of lengths: each gets the width that it fills there.
// Of a field and particles the wider shape gets more, so that both are about as high.
std::string shares_of_views(const std::vector<ParticleMap>& maps,
                            const std::vector<std::size_t>& runs) {
    constexpr double most = 2.4;   // times as wide as the other
    constexpr double least = 1.2;  // below, both alike
    if (runs.size() != 2) return "";
    std::array<const ParticleMap*, 2> shown{};
    for (std::size_t v = 0; v < 2; ++v) {
        shown.at(v) = &*std::ranges::find(maps, runs[v], &ParticleMap::run);
    }
    const bool one_scale = shown[0]->is_field == shown[1]->is_field;
    const auto width = [one_scale](const ParticleMap& map) {
        const double unit = one_scale ? map.diameter : map.y[1] - map.y[0];
        return unit > 0 ? (map.x[1] - map.x[0]) / unit : 1;
    };
    const double ratio = std::clamp(width(*shown[0]) / width(*shown[1]), 1 / most, most);
    if (!(std::max(ratio, 1 / ratio) > least)) return "";
    return fmt::format(" style=\"--shares: {:.2f}fr 1fr\"", ratio);
}

}  // namespace

std::vector<std::size_t> runs_with_pictures(const PageContent& content) {
    std::vector<std::size_t> runs;
    for (std::size_t r = 0; r < content.runs.size(); ++r) {
        if (std::ranges::any_of(content.maps, [&](const ParticleMap& map) { return map.run == r; }))
            runs.push_back(r);
    }
    return runs;
}

std::string map_html(const PageContent& content) {
    const std::string heading = map_heading(content.maps);
    const bool has_particles = std::ranges::any_of(content.runs, [](const Results& run) {
        return run.identity.role != RunRole::critical_point && !run.identity.is_field();
    });
    if (content.maps.empty() && !has_particles) return "";
    if (content.maps.empty()) {
        return "<p class=\"absent\">No picture: the results hold no preview.</p>\n";
    }
    const std::vector<std::size_t> runs = runs_with_pictures(content);
    std::string out = "<section class=\"pictures\"><h2>" + heading + "</h2>\n";
    out +=
        "<figure id=\"map\"><div class=\"controls\">\n"
        "<span class=\"marks kinds\" role=\"group\" aria-label=\"Marks\">";
    const bool only_fields =
        std::ranges::all_of(content.maps, [](const ParticleMap& map) { return map.is_field; });
    for (const char* marks : {"outlines", "centres", "discs", "none"}) {
        out +=
            fmt::format("<button type=\"button\" value=\"{0}\" aria-pressed=\"{1}\">{0}</button>",
                        marks, std::string_view(marks) == "outlines");
    }
    out += fmt::format(
        "</span>\n<button type=\"button\" class=\"lens-switch\" aria-pressed=\"{}\">lens</button>\n"
        "<button type=\"button\" class=\"trails\" aria-pressed=\"false\" title=\"Straight lines "
        "between the places in the frames shown; steps over 3 a are left out\">trails</button>\n"
        "<span class=\"zoom marks\" role=\"group\" aria-label=\"Zoom\">"
        "<button type=\"button\" value=\"0.7\" title=\"Closer\">+</button>"
        "<button type=\"button\" value=\"1.4\" title=\"Further\">−</button>"
        "<button type=\"button\" value=\"0\">all</button></span>\n"
        "<label>Colour <select class=\"pick-colour\"><option value=\"order\">order</option>"
        "<option value=\"identity\">identity</option><option value=\"layer\">layer</option>"
        "</select></label>\n",
        only_fields ? "false" : "true");
    out += colour_bar(content.maps.front().order) + "</div>\n";
    out += "<div class=\"views\"" + shares_of_views(content.maps, runs) + ">\n";
    const bool has_choice = runs.size() > kMostViews;
    for (std::size_t v = 0; v < std::min(kMostViews, runs.size()); ++v) {
        out += view_html(content, runs, runs[v], has_choice);
    }
    out +=
        "</div>\n"
        "<label class=\"frames\">Frame <input type=\"range\" class=\"pick-frame\" min=\"0\" "
        "value=\"0\"><output></output></label>\n"
        "<p class=\"readout\" aria-live=\"off\"></p>\n";
    out += places_html(content);
    std::string links;
    for (const ParticleMap& map : content.maps) links += file_links(content, map.name);
    if (!links.empty()) {
        out += "<details class=\"files\"><summary>Files</summary>" + links + "</details>\n";
    }
    out += "</figure>\n";
    if (has_choice) out += "<div class=\"gallery\" aria-label=\"One map of each run\"></div>\n";
    return out + "</section>\n";
}

}  // namespace grainfield::report
