#include "report/page/page.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/figures/colours.h"
#include "report/figures/plotly_figure.h"
#include "report/maps/spectrum_map.h"
#include "report/page/absences.h"
#include "report/page/cards.h"
#include "report/page/definitions.h"
#include "report/page/embedded.h"
#include "report/page/key_numbers.h"
#include "report/page/paper_section.h"
#include "report/page/run_record.h"
#include "report/run_labels.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

std::string policy() {
    const auto hash = [](std::string_view sha256) {
        return "'sha256-" + base64(bytes_of_hex(sha256)) + "'";
    };
    return "default-src 'none'; script-src " + hash(page_script_sha256) + " " +
           hash(plotly_script_sha256) +
           "; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";
}

std::string percent_encoded(std::string_view path) {
    std::string out;
    for (char c : path) {
        const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                           (c >= 'a' && c <= 'z') ||
                           std::string_view("-._~/").find(c) != std::string_view::npos;
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

// Links to those of the files that exist.
std::string file_links(const PageContent& content, const std::string& name) {
    std::string links;
    for (const char* kind : {"svg", "pdf", "csv"}) {
        const std::string file = name + "." + kind;
        if (std::ranges::find(content.files, file) == content.files.end()) continue;
        links += fmt::format("{}<a href=\"{}\">{}</a>", links.empty() ? "" : " · ",
                             percent_encoded("./" + content.files_folder + "/" + file), file);
    }
    return links.empty() ? "" : "<p class=\"files\">" + links + "</p>\n";
}

std::size_t places_of(const PageContent& content, std::size_t run) {
    std::size_t places = 0;
    for (const ParticleMap& map : content.maps) {
        if (map.run == run) places += map.places.size();
    }
    return places;
}

std::string frames_text(const Results& run) {
    if (run.identity.role == RunRole::critical_point || run.identity.is_field()) return "";
    return fmt::format("{} frame{}", count_text(static_cast<double>(run.frames)),
                       run.frames == 1 ? "" : "s");
}

// Its parts, those that are not empty, with a dot between them.
std::string joined(const std::vector<std::string>& parts) {
    std::string out;
    for (const std::string& part : parts) {
        if (!part.empty()) out += (out.empty() ? "" : " · ") + escape_html(part);
    }
    return out;
}

bool is_critical(const Results& run) {
    return run.identity.role == RunRole::critical_point;
}

// The only critical point among several runs.
std::optional<std::size_t> critical_run(const std::vector<Results>& runs) {
    if (std::ranges::count_if(runs, is_critical) != 1) return std::nullopt;
    return static_cast<std::size_t>(std::ranges::find_if(runs, is_critical) - runs.begin());
}

std::string of_critical(const std::vector<Results>& runs) {
    const std::size_t others = runs.size() - 1;
    return fmt::format("a critical point and {} run{}", others, others == 1 ? "" : "s");
}

std::string header_html(const PageContent& content) {
    const std::size_t count = content.runs.size();
    std::string out = "<header><h1>" + escape_html(content.title) + "</h1>\n";
    const std::size_t warnings = count_warnings(content.runs, content.labels, content.plan);
    std::string also;
    if (warnings > 0) {
        also = fmt::format("; <a href=\"#warnings\">{} warning{}</a>", warnings,
                           warnings == 1 ? "" : "s");
    }
    const auto said = [&](std::size_t r) {
        return escape_html(verdict(content.runs[r], places_of(content, r)));
    };
    if (count == 1) {
        const Results& run = content.runs[0];
        const std::string label = content.labels[0] == content.title ? "" : content.labels[0];
        return out + "<p class=\"summary\">" +
               joined({label, first_file(run), frames_text(run), content.date}) + "</p>\n" +
               "<p class=\"verdict\">" + said(0) + also + "</p></header>\n";
    }
    std::string runs;
    const bool has_verdict = content.paper.empty() && critical_run(content.runs).has_value();
    for (std::size_t r = 0; r < count; ++r) {
        if (has_verdict && is_critical(content.runs[r])) continue;  // said above them
        runs += fmt::format(
            "<li><span class=\"block\" style=\"color:{}\"></span>{} <span class=\"summary\">{}"
            "</span></li>\n",
            hex(distinct_colour(r, count)), escape_html(content.labels[r]), said(r));
    }
    if (!content.paper.empty()) {
        return out + "<p class=\"summary\">" +
               joined({fmt::format("{} runs", count), content.date}) + "</p>\n" +
               "<p class=\"verdict\">" + escape_html(paper_verdict(content.runs)) + also +
               "</p>\n<details class=\"run-key\"><summary>The runs</summary><ul>" + runs +
               "</ul></details></header>\n";
    }
    if (!content.verdict.empty()) {
        out += "<p class=\"summary\">" + joined({first_file(content.runs.front()), content.date}) +
               "</p>\n" + "<p class=\"verdict\">" + escape_html(content.verdict) + also + "</p>\n";
        if (!content.key_numbers) return out + "</header>\n";
        out += "<ul class=\"run-key\">";
    } else if (const auto critical = critical_run(content.runs)) {
        out += "<p class=\"summary\">" + joined({of_critical(content.runs), content.date}) +
               "</p>\n<p class=\"verdict\">" + said(*critical) + also +
               "</p>\n<ul class=\"run-key\">";
    } else {
        out += "<p class=\"summary\">" +
               joined({fmt::format("{} runs side by side", count), content.date}) + also +
               "</p>\n<ul class=\"run-key\">";
    }
    return out + runs + "</ul></header>\n";
}

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
           ": arrow keys move the lens, plus and minus zoom, 0 shows all\"><canvas></canvas>"
           "<div class=\"plot\" role=\"img\" aria-label=\"Particles\"></div>"
           "<canvas class=\"lens\" hidden></canvas></div></div>\n";
}

// A wide picture beside a tall one gets more of the width, so that both are about as high.
std::string shares_of_views(const std::vector<ParticleMap>& maps,
                            const std::vector<std::size_t>& runs) {
    constexpr double most = 2.4;   // times as wide as the other
    constexpr double least = 1.2;  // below, both alike
    if (runs.size() != 2) return "";
    std::array<double, 2> shape{1, 1};  // width over height
    for (std::size_t v = 0; v < 2; ++v) {
        const auto map = std::ranges::find(maps, runs[v], &ParticleMap::run);
        const double height = map->y[1] - map->y[0];
        if (height > 0) shape.at(v) = (map->x[1] - map->x[0]) / height;
    }
    const double ratio = std::clamp(shape[0] / shape[1], 1 / most, most);
    if (!(std::max(ratio, 1 / ratio) > least)) return "";
    return fmt::format(" style=\"--shares: {:.2f}fr 1fr\"", ratio);
}

std::string map_html(const PageContent& content) {
    const std::string heading = map_heading(content.maps);
    const bool has_particles = std::ranges::any_of(content.runs, [](const Results& run) {
        return !is_critical(run) && !run.identity.is_field();
    });
    if (content.maps.empty() && !has_particles) return "";
    if (content.maps.empty()) {
        return "<p class=\"absent\">No picture: the results hold no preview.</p>\n";
    }
    std::vector<std::size_t> runs;
    for (std::size_t r = 0; r < content.runs.size(); ++r) {
        if (std::ranges::any_of(content.maps, [&](const ParticleMap& map) { return map.run == r; }))
            runs.push_back(r);
    }
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
    const bool has_choice = runs.size() > 2;
    for (std::size_t v = 0; v < std::min<std::size_t>(2, runs.size()); ++v) {
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

constexpr std::string_view differences_name = "differences";

// Of a comparison the differences come after the curves, all other tables before them.
std::string tables_html(const PageContent& content, bool differences) {
    std::string out;
    for (const Table& table : content.tables) {
        if ((table.name == differences_name) != differences) continue;
        out += table_html(table) + file_links(content, table.name);
    }
    if (out.empty()) return "";
    return fmt::format("<section class=\"tables\">{}{}</section>\n",
                       differences ? "" : "<h2>Tables</h2>\n", out);
}

// With its lines, which escape_html joins.
std::string escaped_lines(const std::string& text) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        out += escape_html(text.substr(at, end - at)) + "\n";
        at = end + 1;
    }
    return out;
}

std::string blocks_html(const PageContent& content) {
    if (content.blocks.empty()) return "";
    std::string out = "<div class=\"blocks\">\n";
    for (const CopyBlock& block : content.blocks) {
        out += "<section><h3>" + escape_html(block.title) +
               "</h3>\n<button type=\"button\" class=\"copy\">Copy</button><pre tabindex=\"0\">" +
               escaped_lines(block.text) + "</pre>\n";
        if (!block.note.empty()) out += "<p class=\"note\">" + escape_html(block.note) + "</p>\n";
        out += "</section>\n";
    }
    return out + "</div>\n";
}

std::string numbers_html(const PageContent& content) {
    const std::string table =
        key_numbers_html(key_numbers(content.runs, content.titles), content.labels);
    return "<section><h2>All numbers</h2>\n<details><summary>Each with its error and samples"
           "</summary>" +
           table + "</details></section>\n";
}

bool is_of_paper(const Figure& figure) {
    return figure.group == FigureGroup::paper;
}

// What a critical point is asked for stands above all else.
std::string critical_html(const PageContent& content) {
    std::string out;
    for (const Figure& figure : content.figures) {
        if (is_of_critical_point(figure)) out += figure_html(content, figure);
    }
    if (out.empty()) return "";
    return "<section class=\"figures\" aria-label=\"Critical point\">\n" + out + "</section>\n";
}

// The figures that say how to read them come first.
std::string figures_html(const PageContent& content, bool first) {
    std::string out;
    for (const Figure& figure : content.figures) {
        if (is_of_critical_point(figure) || is_of_paper(figure)) continue;
        if (figure.reading.empty() != first) out += figure_html(content, figure);
    }
    return out;
}

std::string data_json(const PageContent& content) {
    std::string figures;
    for (const Figure& figure : content.figures) {
        if (figure.has_data()) figures += (figures.empty() ? "" : ",\n") + plotly_json(figure);
    }
    std::string maps;
    for (const ParticleMap& map : content.maps) maps += (maps.empty() ? "" : ",\n") + map_json(map);
    nlohmann::json colours = nlohmann::json::array();
    for (int level = 0; level < 255; ++level) colours.push_back(hex(viridis(level / 254.0)));
    nlohmann::json labels = nlohmann::json::array();
    for (const std::string& label : content.labels) labels.push_back(clean_text(label));
    return "{\"runs\":" + escape_json_for_script(labels.dump()) +
           ",\n\"colours\":" + colours.dump() + ",\n\"figures\":[" + figures + "],\n\"maps\":[" +
           maps + "],\n\"alternatives\":" + alternatives_json(content.alternatives) + "}";
}

}  // namespace

std::string page_html(const PageContent& content) {
    std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
    out += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy() + "\">\n";
    out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    out += "<title>" + escape_html(content.title) + "</title>\n<style>\n";
    out += page_style;
    out += "</style>\n</head>\n<body>\n<main>\n" + header_html(content);
    out +=
        "<noscript><p class=\"absent\">The plots need JavaScript; it runs on this machine "
        "only.</p></noscript>\n";
    const std::string warnings = warnings_html(content.runs, content.labels, content.plan);
    const std::string tables = tables_html(content, false);
    const std::string pictures = map_html(content);
    if (!content.paper.empty()) {
        const auto run = run_of_paper_map(content.runs);
        out += paper_section_html(content.paper, paper_map(content.maps, run),
                                  run ? content.labels[*run] : "");
        out += pictures + tables + warnings + critical_html(content);
    } else if (content.key_numbers) {
        out += critical_html(content);
        constexpr std::size_t most_runs = 4;  // on a card
        const std::string cards =
            content.runs.size() > most_runs
                ? ""
                : cards_html(make_cards(content.runs, content.sphere_mm), content.labels);
        const bool one_run = content.runs.size() == 1;
        out += fmt::format("<div class=\"first{}\">\n", one_run && !cards.empty() ? " beside" : "");
        const std::string missing = absences_html(content.runs, content.labels, content.titles);
        out += pictures + "<div>" + cards + missing + warnings + "</div></div>\n" + tables;
    } else {
        out += critical_html(content) + pictures + alternatives_html(content.alternatives) +
               blocks_html(content) + warnings + tables;
    }
    if (const std::string first = figures_html(content, true); !first.empty()) {
        out += "<section class=\"figures\" aria-label=\"Main curves\">\n" + first + "</section>\n";
    }
    out += tables_html(content, true);
    const std::string more = figures_html(content, false) + spectrum_maps_html(content);
    if (!more.empty()) {
        out += std::string(content.key_numbers ? "<h2>More curves</h2>\n" : "") +
               "<section class=\"figures\">\n" + more + "</section>\n";
    }
    if (!content.paper.empty()) {
        out +=
            "<h2>Not measured</h2>\n" + absences_html(content.runs, content.labels, content.titles);
    }
    if (content.key_numbers) out += numbers_html(content);
    out += skipped_html(content.runs, content.labels, content.plan);
    out += "<section><h2>How this was made</h2>\n";
    out += records_html(content.runs, content.labels) + "</section>\n</main>\n";
    out += "<script type=\"application/json\" id=\"report-data\">\n" + data_json(content);
    out += "\n</script>\n<script>";
    out += page_script;
    out += "</script>\n<!-- plotly.js, https://plotly.com/javascript\n\n";
    out += plotly_licence;
    out += "-->\n<script>";
    out += plotly_script;
    return out + "</script>\n</body>\n</html>\n";
}

}  // namespace grainfield::report
