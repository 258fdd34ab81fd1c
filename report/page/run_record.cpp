#include "report/page/run_record.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/support/progress.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

std::string who(const std::vector<std::string>& some, std::size_t all) {
    if (some.size() == all) return "all runs";
    std::string out = some.front();
    for (std::size_t i = 1; i < some.size(); ++i) out.append("; ").append(some[i]);
    return out;
}

// What a remark is about: its first clause without numbers and names.
std::string kind_of(const std::string& text) {
    std::string kind;
    bool in_name = false;
    for (const char c : text) {
        if (c == '\'' && (in_name || kind.empty() || kind.back() == ' ')) {
            in_name = !in_name;
            kind += c;
        } else if (in_name) {
            continue;
        } else if (c == ';') {
            break;
        } else if (std::string_view("0123456789.+-").find(c) == std::string_view::npos) {
            kind += c;
        }
    }
    return kind;
}

// "tracked, Γ = 2.5; tracked, Γ = 3 and 4 more"
std::string some_of(const std::vector<std::string>& runs) {
    constexpr std::size_t most = 3;
    std::string out;
    for (std::size_t i = 0; i < std::min(most, runs.size()); ++i) {
        out += (i > 0 ? "; " : "") + runs[i];
    }
    if (runs.size() > most) out += fmt::format(" and {} more", runs.size() - most);
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
        std::string out = fmt::format(
            "<section class=\"remarks {0}\" id=\"{0}\"><h2>{1}</h2><ul>\n", style, heading);
        for (const Item& item : items_) {
            out += "<li>" + escape_html(item.text);
            if (runs > 1 && !item.runs.front().empty()) {
                out += " <span class=\"who\">" + escape_html(who(item.runs, runs)) + "</span>";
            }
            out += "</li>\n";
        }
        return out + "</ul></section>\n";
    }
    // One line a kind: texts that differ in numbers and names alone are folded under the first.
    std::string html_by_kind(const std::string& heading, const std::string& style,
                             std::size_t runs) const {
        const auto kinds = by_kind();
        if (kinds.empty()) return "";
        std::string out = fmt::format(
            "<section class=\"remarks {0}\" id=\"{0}\"><h2>{1}</h2><ul>\n", style, heading);
        for (const auto& [kind, items] : kinds) out += "<li>" + kind_html(items, runs) + "</li>\n";
        return out + "</ul></section>\n";
    }

    std::size_t lines() const { return items_.size(); }
    std::size_t kinds() const { return by_kind().size(); }

 private:
    struct Item {
        std::string text;
        std::vector<std::string> runs;
    };

    std::vector<std::pair<std::string, std::vector<const Item*>>> by_kind() const {
        std::vector<std::pair<std::string, std::vector<const Item*>>> kinds;
        for (const Item& item : items_) {
            const std::string kind = kind_of(item.text);
            auto known =
                std::ranges::find_if(kinds, [&](const auto& other) { return other.first == kind; });
            if (known == kinds.end()) {
                kinds.push_back({kind, {}});
                known = kinds.end() - 1;
            }
            known->second.push_back(&item);
        }
        return kinds;
    }

    static std::string kind_html(const std::vector<const Item*>& items, std::size_t runs) {
        std::vector<std::string> all;
        for (const Item* item : items) {
            for (const std::string& run : item->runs) {
                if (!run.empty() && std::ranges::find(all, run) == all.end()) all.push_back(run);
            }
        }
        const std::string concerned =
            all.empty()
                ? ""
                : " <span class=\"who\">" +
                      escape_html(all.size() == runs ? "all runs" : some_of(all)) + "</span>";
        std::string line = escape_html(items.front()->text) + concerned;
        if (items.size() == 1 && all.size() <= 3) return line;
        std::string list;
        for (const Item* item : items) {
            const std::string whose =
                item->runs.front().empty() ? "" : who(item->runs, runs) + ": ";
            list += "<li>" + escape_html(whose + item->text) + "</li>\n";
        }
        return "<details><summary>" + line + "</summary><ul>\n" + list + "</ul></details>";
    }
    std::vector<Item> items_;
};

// The records of a run and of what it was made from, oldest first.
std::vector<const RunRecord*> history(const Results& run) {
    std::vector<const RunRecord*> records;
    for (const RunRecord& record : run.sources) records.push_back(&record);
    records.push_back(&run.record);
    return records;
}

std::string bytes_text(std::uint64_t bytes) {
    return count_text(static_cast<double>(bytes)) + " B";
}

std::string inputs_html(const RunRecord& record) {
    if (record.inputs.empty()) return "";
    const std::size_t count = record.inputs.size();
    constexpr std::size_t most_open = 12;
    std::string out;
    if (count > most_open)
        out = fmt::format("<details><summary>Inputs ({} files)</summary>", count);
    out +=
        "<div class=\"scroll\"><table class=\"inputs\"><thead><tr><th>Input</th><th>Size</th>"
        "<th>Checksum</th></tr></thead><tbody>\n";
    for (const RunRecord::Input& input : record.inputs) {
        out += fmt::format("<tr><td>{}</td><td>{}</td><td><code>{}</code></td></tr>\n",
                           escape_html(input.name), bytes_text(input.bytes),
                           escape_html(input.checksum));
    }
    out += "</tbody></table></div>\n";
    return count > most_open ? out + "</details>\n" : out;
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

constexpr std::size_t most_listed = 4;  // of runs whose warnings stand one by one

Remarks warnings_of(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                    const RunPlan& plan) {
    Remarks warnings;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (const RunRecord* record : history(runs[r])) {
            for (const Warning& warning : record->warnings) warnings.add(warning.text, labels[r]);
        }
    }
    for (const Warning& warning : plan.warnings()) warnings.add(warning.text, "");
    return warnings;
}

}  // namespace

std::string warnings_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                          const RunPlan& plan) {
    const Remarks warnings = warnings_of(runs, labels, plan);
    return runs.size() > most_listed ? warnings.html_by_kind("Warnings", "warnings", runs.size())
                                     : warnings.html("Warnings", "warnings", runs.size());
}

std::size_t count_warnings(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                           const RunPlan& plan) {
    const Remarks warnings = warnings_of(runs, labels, plan);
    return runs.size() > most_listed ? warnings.kinds() : warnings.lines();
}

std::string skipped_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                         const RunPlan& plan) {
    Remarks skipped;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (const RunRecord* record : history(runs[r])) {
            for (const std::string& text : record->skipped) skipped.add(text, labels[r]);
        }
    }
    for (const PlannedStage& stage : plan.skipped()) {
        skipped.add(stage.stage + ": " + stage.reason, "");
    }
    return skipped.html("Skipped", "skipped", runs.size());
}

std::string records_html(const std::vector<Results>& runs, const std::vector<std::string>& labels) {
    std::string out;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        out += "<article class=\"record\"><h3>" + escape_html(labels[r]) + "</h3>\n";
        for (const RunRecord* record : history(runs[r])) {
            out += fmt::format("<p>grainfield {}, <code>{}</code>, seed {}, {} thread{}, {}</p>\n",
                               escape_html(record->version), escape_html(record->command),
                               record->seed, record->threads, record->threads == 1 ? "" : "s",
                               format_duration(record->seconds));
            out += inputs_html(*record) + configuration_html(*record);
        }
        out += "</article>\n";
    }
    return out;
}

}  // namespace grainfield::report
