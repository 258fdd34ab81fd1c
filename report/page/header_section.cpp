#include "report/page/header_section.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "report/figures/colours.h"
#include "report/page/cards.h"
#include "report/page/run_record.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

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

}  // namespace

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

}  // namespace grainfield::report
