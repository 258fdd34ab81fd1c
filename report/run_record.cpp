#include "report/run_record.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/progress.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

std::string who(const std::vector<std::string>& some, std::size_t all) {
    if (some.size() == all) return "all runs";
    std::string out = some.front();
    for (std::size_t i = 1; i < some.size(); ++i) out.append("; ").append(some[i]);
    return out;
}

// Texts in order of first appearance, each with the runs that say it.
class Remarks {
 public:
    void add(const std::string& text, const std::string& run) {
        const auto known = std::ranges::find(items_, text, &Item::text);
        if (known == items_.end()) {
            items_.push_back({text, {run}});
        } else if (std::ranges::find(known->runs, run) == known->runs.end()) {
            known->runs.push_back(run);
        }
    }
    std::string html(const std::string& heading, const std::string& style, std::size_t runs) const {
        if (items_.empty()) return "";
        std::string out =
            fmt::format("<section class=\"remarks {}\"><h2>{}</h2><ul>\n", style, heading);
        for (const Item& item : items_) {
            out += "<li>" + escape_html(item.text);
            if (runs > 1 && !item.runs.front().empty()) {
                out += " <span class=\"who\">" + escape_html(who(item.runs, runs)) + "</span>";
            }
            out += "</li>\n";
        }
        return out + "</ul></section>\n";
    }

 private:
    struct Item {
        std::string text;
        std::vector<std::string> runs;
    };
    std::vector<Item> items_;
};

std::string bytes_text(std::uint64_t bytes) {
    return count_text(static_cast<double>(bytes)) + " B";
}

std::string inputs_html(const RunRecord& record) {
    if (record.inputs.empty()) return "";
    std::string out =
        "<div class=\"scroll\"><table class=\"inputs\"><thead><tr><th>Input</th><th>Size</th>"
        "<th>Checksum</th></tr></thead><tbody>\n";
    for (const RunRecord::Input& input : record.inputs) {
        out += fmt::format("<tr><td>{}</td><td>{}</td><td><code>{}</code></td></tr>\n",
                           escape_html(input.name), bytes_text(input.bytes),
                           escape_html(input.checksum));
    }
    return out + "</tbody></table></div>\n";
}

std::string configuration_html(const RunRecord& record) {
    if (record.configuration.empty()) return "";
    std::string out = fmt::format(
        "<details><summary>Configuration ({} options)</summary><div class=\"scroll\"><table "
        "class=\"configuration\"><tbody>\n",
        record.configuration.size());
    for (const auto& [name, value] : record.configuration) {
        out += fmt::format("<tr><th><code>{}</code></th><td><code>{}</code></td></tr>\n",
                           escape_html(name), escape_html(value));
    }
    return out + "</tbody></table></div></details>\n";
}

}  // namespace

std::string remarks_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                         const RunPlan& plan) {
    Remarks warnings;
    Remarks skipped;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (const std::string& text : runs[r].record.warnings) warnings.add(text, labels[r]);
        for (const std::string& text : runs[r].record.skipped) skipped.add(text, labels[r]);
    }
    for (const std::string& text : plan.warnings()) warnings.add(text, "");
    for (const PlannedStage& stage : plan.skipped()) {
        skipped.add(stage.stage + ": " + stage.reason, "");
    }
    return warnings.html("Warnings", "warnings", runs.size()) +
           skipped.html("Skipped", "skipped", runs.size());
}

std::string records_html(const std::vector<Results>& runs, const std::vector<std::string>& labels) {
    std::string out;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const RunRecord& record = runs[r].record;
        out += "<article class=\"record\"><h3>" + escape_html(labels[r]) + "</h3>\n<p>";
        out += fmt::format("grainfield {}, <code>{}</code>, seed {}, {} thread{}, {}</p>\n",
                           escape_html(record.version), escape_html(record.command), record.seed,
                           record.threads, record.threads == 1 ? "" : "s",
                           format_duration(record.seconds));
        out += inputs_html(record) + configuration_html(record) + "</article>\n";
    }
    return out;
}

}  // namespace grainfield::report
