#include "report/page/page.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/figures/colours.h"
#include "report/figures/plotly_figure.h"
#include "report/page/absences.h"
#include "report/page/cards.h"
#include "report/page/embedded.h"
#include "report/page/figure_section.h"
#include "report/page/header_section.h"
#include "report/page/map_section.h"
#include "report/page/paper_section.h"
#include "report/page/run_record.h"
#include "report/page/space_section.h"
#include "report/page/table_section.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

std::string policy() {
    const auto hash = [](std::string_view sha256) {
        return "'sha256-" + base64(bytes_of_hex(sha256)) + "'";
    };
    return "default-src 'none'; script-src " + hash(page_script_sha256) + " " +
           hash(plotly_script_sha256) + " " + hash(space_script_sha256) +
           "; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";
}

// By map, whether its image follows the scripts: nothing in sight waits for it.
std::vector<bool> images_that_follow(const PageContent& content) {
    std::vector<std::size_t> shown = runs_with_pictures(content);
    shown.resize(std::min(shown.size(), kMostViews));
    std::vector<bool> follows;
    for (const ParticleMap& map : content.maps) {
        follows.push_back(!map.png.empty() && std::ranges::find(shown, map.run) == shown.end());
    }
    return follows;
}

// {"index among the maps": image}; empty where none follows.
std::string following_images_json(const PageContent& content, const std::vector<bool>& follows) {
    nlohmann::json images;
    for (std::size_t m = 0; m < follows.size(); ++m) {
        if (follows[m]) images[std::to_string(m)] = map_image(content.maps[m]);
    }
    return images.empty() ? "" : images.dump();
}

std::string data_json(const PageContent& content, const std::vector<bool>& follows) {
    std::string figures;
    for (const Figure& figure : content.figures) {
        if (figure.has_data()) figures += (figures.empty() ? "" : ",\n") + plotly_json(figure);
    }
    std::string maps;
    for (std::size_t m = 0; m < follows.size(); ++m) {
        maps += (maps.empty() ? "" : ",\n") + map_json(content.maps[m], !follows[m]);
    }
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
    const std::string tables = tables_html(content);
    const std::string pictures = map_html(content);
    const std::string space = space_html(content);
    if (!content.paper.empty()) {
        const auto run = run_of_paper_map(content.runs);
        out += paper_section_html(content.paper, paper_map(content.maps, run),
                                  run ? content.labels[*run] : "");
        out += pictures + space + tables + warnings + critical_html(content);
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
        out += pictures + "<div>" + cards + missing + warnings + "</div></div>\n" + space + tables;
    } else {
        out += critical_html(content) + pictures + alternatives_html(content.alternatives) +
               blocks_html(content.blocks) + space + warnings + tables;
    }
    out += main_curves_html(content) + differences_html(content) + more_curves_html(content);
    if (!content.paper.empty()) {
        out +=
            "<h2>Not measured</h2>\n" + absences_html(content.runs, content.labels, content.titles);
    }
    if (content.key_numbers) out += numbers_html(content);
    out += skipped_html(content.runs, content.labels, content.plan);
    out += "<section><h2>How this was made</h2>\n";
    out += records_html(content.runs, content.labels) + "</section>\n</main>\n";
    const std::vector<bool> follows = images_that_follow(content);
    out += "<script type=\"application/json\" id=\"report-data\">\n" + data_json(content, follows);
    out += "\n</script>\n<!-- plotly.js, https://plotly.com/javascript\n\n";
    out += plotly_licence;
    out += "-->\n<script>";
    out += plotly_script;
    if (has_space(content)) out.append("</script>\n<script>").append(space_script);
    out.append("</script>\n<script>").append(page_script).append("</script>\n");
    if (const std::string images = following_images_json(content, follows); !images.empty()) {
        out +=
            "<script type=\"application/json\" id=\"report-images\">\n" + images + "\n</script>\n";
    }
    return out + "</body>\n</html>\n";
}

}  // namespace grainfield::report
