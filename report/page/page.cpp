#include "report/page/page.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/figures/colours.h"
#include "report/figures/plotly_figure.h"
#include "report/maps/spectrum_map.h"
#include "report/page/embedded.h"
#include "report/page/key_numbers.h"
#include "report/page/run_record.h"
#include "report/page/text.h"
#include "report/run_labels.h"

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

std::string header_html(const PageContent& content) {
    const std::size_t count = content.runs.size();
    std::string out = "<header><h1>" + escape_html(content.title) + "</h1>\n";
    const auto summary = [](const Results& run) -> std::string {
        if (run.identity.role == RunRole::critical_point) return "critical point";
        if (run.identity.is_field()) return "fields";
        return fmt::format("{} frame{}, {} particles a frame",
                           count_text(static_cast<double>(run.frames)), run.frames == 1 ? "" : "s",
                           count_text(run.particles_mean));
    };
    if (count == 1) {
        return out + "<p class=\"summary\">" + escape_html(content.labels[0]) + " · " +
               summary(content.runs[0]) + "</p></header>\n";
    }
    out +=
        fmt::format("<p class=\"summary\">{} runs side by side</p>\n<ul class=\"run-key\">", count);
    for (std::size_t r = 0; r < count; ++r) {
        out += fmt::format(
            "<li><span class=\"block\" style=\"color:{}\"></span>{} <span class=\"summary\">{}"
            "</span></li>\n",
            hex(distinct_colour(r, count)), escape_html(content.labels[r]),
            summary(content.runs[r]));
    }
    return out + "</ul></header>\n";
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

std::string figure_html(const PageContent& content, const Figure& figure) {
    std::string out =
        fmt::format("<figure id=\"figure-{0}\"><div class=\"head\"><figcaption><h3>{1}</h3>",
                    figure.name, escape_html(figure.title));
    if (!figure.has_data()) {
        out += "</figcaption></div>\n";
        for (const Figure::Absence& absence : figure.absent) {
            const std::string who = content.runs.size() == 1 ? "" : figure.runs[absence.run] + ": ";
            out += "<p class=\"absent\">No plot. " + escape_html(who + absence.reason) + "</p>\n";
        }
        return out + "</figure>\n";
    }
    if (!figure.note.empty()) out += "<p class=\"note\">" + escape_html(figure.note) + "</p>";
    out += fmt::format(
        "</figcaption><div class=\"tools\"></div></div>\n<div class=\"legend\"></div>\n"
        "<div class=\"plot\" id=\"plot-{}\" role=\"img\" aria-label=\"{}\"></div>\n",
        figure.name, escape_html(figure.y.title() + " against " + figure.x.title()));
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

std::string map_html(const PageContent& content) {
    const std::string heading = map_heading(content.maps);
    std::string out = "<section><h2>" + heading + "</h2>\n";
    if (content.maps.empty()) {
        return out + "<p class=\"absent\">No picture: the results hold no preview.</p></section>\n";
    }
    std::string options;
    for (std::size_t r = 0; r < content.runs.size(); ++r) {
        const bool has_map =
            std::ranges::any_of(content.maps, [&](const ParticleMap& map) { return map.run == r; });
        if (!has_map) continue;
        options +=
            fmt::format("<option value=\"{}\">{}</option>", r, escape_html(content.labels[r]));
    }
    const bool one_run = options.find("<option", 1) == std::string::npos;
    out += fmt::format(
        "<figure id=\"map\"><div class=\"controls\">\n"
        "<label{}>Run <select class=\"pick-run\">{}</select></label>\n"
        "<label>Frame <input type=\"range\" class=\"pick-frame\" min=\"0\" value=\"0\"></label>\n"
        "<label>Colour <select class=\"pick-colour\"><option value=\"order\">order</option>"
        "<option value=\"identity\">identity</option><option value=\"layer\">layer</option>"
        "</select></label>\n"
        "<button type=\"button\" class=\"trails\" aria-pressed=\"false\">trails</button>\n"
        "<span class=\"marks\" role=\"group\" aria-label=\"Marks\">",
        one_run ? " hidden" : "", options);
    for (const char* marks : {"discs", "outlines", "centres", "none"}) {
        out +=
            fmt::format("<button type=\"button\" value=\"{0}\" aria-pressed=\"{1}\">{0}</button>",
                        marks, std::string_view(marks) == "discs");
    }
    out += "</span>\n" + colour_bar(content.maps.front().order) +
           "</div>\n<figcaption class=\"caption\"></figcaption>\n"
           "<div class=\"stage\"><canvas></canvas><div class=\"plot\" role=\"img\" "
           "aria-label=\"" +
           heading +
           "\"></div></div>\n"
           "<p class=\"readout\" aria-live=\"off\"></p>\n";
    std::string links;
    for (const ParticleMap& map : content.maps) links += file_links(content, map.name);
    if (content.maps.size() > 2) {
        links = "<details class=\"files\"><summary>Files</summary>" + links + "</details>\n";
    }
    out += links + "</figure>\n";
    if (!one_run) out += "<div class=\"gallery\" aria-label=\"One map of each run\"></div>\n";
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

std::string tables_html(const PageContent& content) {
    std::string out;
    for (const Table& table : content.tables) {
        out += table_html(table) + file_links(content, table.name);
    }
    return out.empty() ? "" : "<section class=\"tables\"><h2>Tables</h2>\n" + out + "</section>\n";
}

// The wide table of many runs is folded: figures come first then.
std::string numbers_html(const PageContent& content) {
    constexpr std::size_t most_open = 8;
    const std::string table =
        key_numbers_html(key_numbers(content.runs, content.titles), content.labels);
    const bool folded = content.runs.size() > most_open;
    return fmt::format("<section><h2>Key numbers</h2>\n{}{}{}</section>\n",
                       folded ? "<details><summary>All numbers of all runs</summary>" : "", table,
                       folded ? "</details>\n" : "");
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
           maps + "]}";
}

}  // namespace

std::string page_html(const PageContent& content) {
    std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
    out += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy() + "\">\n";
    out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    out += "<title>" + escape_html(content.title) + "</title>\n<style>\n";
    out += page_style;
    out += "</style>\n</head>\n<body>\n<main>\n" + header_html(content);
    out += warnings_html(content.runs, content.labels, content.plan);
    out +=
        "<noscript><p class=\"absent\">The plots need JavaScript; it runs on this machine "
        "only.</p></noscript>\n";
    out += tables_html(content);
    if (content.key_numbers) out += numbers_html(content);
    out += map_html(content) + "<section class=\"figures\">\n";
    for (const Figure& figure : content.figures) out += figure_html(content, figure);
    out += spectrum_maps_html(content);
    out += "</section>\n" + skipped_html(content.runs, content.labels, content.plan);
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
