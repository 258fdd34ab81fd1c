#include "report/page/key_numbers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "report/text.h"

namespace grainfield::report {

namespace {

KeyNumber key_number(const Measurement& m) {
    KeyNumber number;
    number.note = clean_text(m.reason);
    if (!m.value || !std::isfinite(*m.value)) {
        if (number.note.empty()) number.note = "no value";
        return number;
    }
    number.value = with_error(*m.value, m.error ? &*m.error : nullptr);
    // Independent samples are an estimate: a fraction of one says nothing.
    if (m.samples >= 2) number.samples = count_text(std::round(m.samples));
    if (m.error && *m.error == 0 && number.note.empty()) {
        number.note = "no fluctuations: the error is not known";
    }
    return number;
}

class Table {
 public:
    explicit Table(std::size_t runs) : runs_(runs) {}

    /// The row of a quantity, made if it is not there.
    KeyNumberRow& row(const std::string& observable, const std::string& name,
                      const std::string& quantity) {
        const auto found = std::ranges::find_if(rows_, [&](const KeyNumberRow& row) {
            return row.observable == observable && row.name == name;
        });
        if (found != rows_.end()) return *found;
        // Behind the last row of its observable.
        const auto last = std::find_if(rows_.rbegin(), rows_.rend(), [&](const KeyNumberRow& row) {
            return row.observable == observable;
        });
        const auto place = last == rows_.rend() ? rows_.end() : last.base();
        KeyNumberRow fresh{observable, clean_text(quantity), name, "", {}};
        fresh.numbers.assign(runs_, {"", "", "not among the results of this run"});
        return *rows_.insert(place, std::move(fresh));
    }
    std::vector<KeyNumberRow> take() { return std::move(rows_); }

 private:
    std::size_t runs_;
    std::vector<KeyNumberRow> rows_;
};

void add_run(Table& table, const Results& run, std::size_t r,
             const std::vector<ObservableTitles>& titles) {
    const auto plain = [&](const char* quantity, double value) {
        KeyNumberRow& row = table.row("Input", quantity, quantity);
        row.numbers[r] = {count_text(value), "", ""};
    };
    plain("Frames", static_cast<double>(run.frames));
    plain("Particles per frame", run.particles_mean);
    for (const ObservableResult& observable : run.observables) {
        const std::string title = clean_text(observable_title(titles, observable.name));
        if (observable.measurements.empty() && !observable.reason.empty()) {
            table.row(title, "not measured", "not measured").numbers[r] = {
                "", "", clean_text(observable.reason)};
        }
        for (const Measurement& m : observable.measurements) {
            KeyNumberRow& row =
                table.row(title, m.name, quantity_title(titles, observable.name, m.name));
            row.numbers[r] = key_number(m);
            if (row.unit.empty()) row.unit = typeset_text(m.unit, run.source.time_unit);
            const std::string unit = typeset_text(m.unit, run.source.time_unit);
            if (unit != row.unit && !row.numbers[r].value.empty()) {
                row.numbers[r].value += " " + unit;
            }
        }
    }
}

std::string value_text(const KeyNumber& number) {
    return number.value.empty() ? "–" : escape_html(number.value);
}

// Notes below the table, each once.
class Notes {
 public:
    std::string reference(const std::string& note) {
        if (note.empty()) return "";
        const auto known = std::ranges::find(notes_, note);
        const auto place = known - notes_.begin();
        if (known == notes_.end()) notes_.push_back(note);
        return fmt::format("<sup>{}</sup>", place + 1);
    }
    std::string html() const {
        if (notes_.empty()) return "";
        std::string out = "<ol class=\"notes\">\n";
        for (const std::string& note : notes_) out += "<li>" + escape_html(note) + "</li>\n";
        return out + "</ol>\n";
    }

 private:
    std::vector<std::string> notes_;
};

std::string compact_cell(const KeyNumber& number, Notes& notes) {
    const std::string note = number.value.empty() ? "" : number.note;
    std::string out = "<td>" + value_text(number) + notes.reference(note);
    if (!number.samples.empty()) {
        out += "<span class=\"samples\">n = " + escape_html(number.samples) + "</span>";
    }
    return out + "</td>";
}

}  // namespace

std::vector<KeyNumberRow> key_numbers(const std::vector<Results>& runs,
                                      const std::vector<ObservableTitles>& titles) {
    Table table(runs.size());
    for (std::size_t r = 0; r < runs.size(); ++r) add_run(table, runs[r], r, titles);
    return table.take();
}

std::string key_numbers_html(const std::vector<KeyNumberRow>& rows,
                             const std::vector<std::string>& labels) {
    const bool one_run = labels.size() == 1;
    Notes notes;
    std::string out = "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th>Quantity</th>";
    if (one_run) {
        out += "<th>Value</th><th class=\"count\">Samples</th><th>Remark</th>";
    } else {
        for (const std::string& label : labels) out += "<th>" + escape_html(label) + "</th>";
    }
    out += "</tr></thead>\n<tbody>\n";
    const std::string* group = nullptr;
    const auto has_value = [](const KeyNumber& number) { return !number.value.empty(); };
    for (const KeyNumberRow& row : rows) {
        // What no run has is said elsewhere, in one line.
        if (std::ranges::none_of(row.numbers, has_value)) continue;
        if (group == nullptr || row.observable != *group) {
            group = &row.observable;
            out += fmt::format("<tr class=\"group\"><th colspan=\"{}\">{}</th></tr>\n",
                               one_run ? 4 : labels.size() + 1, escape_html(*group));
        }
        const std::string unit =
            row.unit.empty() ? "" : " <span class=\"unit\">[" + escape_html(row.unit) + "]</span>";
        out += fmt::format("<tr><th title=\"{}\">{}{}</th>", escape_html(row.name),
                           escape_html(row.quantity), unit);
        if (one_run) {
            const KeyNumber& number = row.numbers.front();
            out += fmt::format("<td>{}</td><td>{}</td><td class=\"remark\">{}</td>",
                               value_text(number), escape_html(number.samples),
                               escape_html(number.note));
        } else {
            for (const KeyNumber& number : row.numbers) out += compact_cell(number, notes);
        }
        out += "</tr>\n";
    }
    return out + "</tbody></table></div>\n" + notes.html();
}

}  // namespace grainfield::report
