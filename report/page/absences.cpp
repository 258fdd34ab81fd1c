#include "report/page/absences.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/text.h"

namespace grainfield::report {

namespace {

bool is_missing(const Measurement& m) {
    return !m.value || !std::isfinite(*m.value);
}

// Whether the reason is that there is one frame, or one moment.
bool blames_one_frame(const Results& run, const std::string& reason) {
    if (run.frames != 1) return false;
    for (const char* words : {"one frame", "one window", "every frame", "too few frames",
                              "no window in which", "one moment"}) {
        if (reason.find(words) != std::string::npos) return true;
    }
    return false;
}

// "Lattice spacing" as a part of a sentence; symbols and abbreviations keep their letters.
std::string inside_sentence(std::string title) {
    const bool is_word = title.size() > 1 && title[0] >= 'A' && title[0] <= 'Z' &&
                         title[1] >= 'a' && title[1] <= 'z';
    if (is_word) title[0] = static_cast<char>(title[0] - 'A' + 'a');
    return title;
}

std::string listed(const std::vector<Absent>& all, bool one_frame) {
    std::string text;
    for (const Absent& absent : all) {
        if (absent.one_frame != one_frame) continue;
        if (!text.empty()) text.append(", ");
        text.append(absent.what);
    }
    return text;
}

std::string line(const std::vector<Absent>& all) {
    const std::string of_one = listed(all, true);
    const std::string others = listed(all, false);
    std::string text;
    if (!of_one.empty()) text = "Not possible with one frame: " + of_one + ".";
    if (!others.empty()) {
        if (!text.empty()) text.append(" ");
        text.append("Not measured: ").append(others).append(".");
    }
    return text;
}

}  // namespace

std::vector<Absent> absences(const Results& run, const std::vector<ObservableTitles>& titles) {
    std::vector<Absent> all;
    const auto add = [&](const std::string& what, const std::string& reason) {
        const std::string why = clean_text(reason.empty() ? "no value" : reason);
        // One of the boxes of `synthetic`, whose sides the user names.
        const std::string of_box = "box ";
        const std::string name = what.starts_with(of_box)
                                     ? "number variance of a box of " + what.substr(4) + " a"
                                     : what;
        all.push_back({inside_sentence(clean_text(name)), why, blames_one_frame(run, why)});
    };
    for (const ObservableResult& observable : run.observables) {
        const std::string title = observable_title(titles, observable.name);
        const auto missing = std::ranges::count_if(observable.measurements, is_missing);
        const auto size = static_cast<std::ptrdiff_t>(observable.measurements.size());
        if (observable.measurements.empty()) {
            if (!observable.reason.empty()) add(title, observable.reason);
            continue;
        }
        // A spectrum is drawn of one frame too: it is not missing as a whole.
        const bool is_drawn = observable.name == "sk" && observable.find_curve("sk") != nullptr;
        if (missing == size && size > 1 && !is_drawn) {
            add(title, observable.measurements.front().reason);
            continue;
        }
        // One reason of several numbers is said once, under the name of the whole.
        const auto of_one = std::ranges::count_if(observable.measurements, [&](const auto& m) {
            return is_missing(m) && blames_one_frame(run, m.reason);
        });
        bool is_named = false;
        for (const Measurement& m : observable.measurements) {
            if (!is_missing(m)) continue;
            if (of_one > 1 && blames_one_frame(run, m.reason)) {
                const std::string first = quantity_title(titles, observable.name, m.name);
                if (!std::exchange(is_named, true)) add(is_drawn ? first : title, m.reason);
                continue;
            }
            add(quantity_title(titles, observable.name, m.name), m.reason);
        }
    }
    if (run.frames == 1 && run.find("sk") != nullptr && !run.identity.is_field()) {
        all.push_back(
            {"errors of S(k)", "one frame: errors come from the scatter between frames", true});
    }
    return all;
}

std::string absences_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                          const std::vector<ObservableTitles>& titles) {
    struct Line {
        std::string text, reasons;
        std::vector<std::string> whose;
    };
    std::vector<Line> lines;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::vector<Absent> all = absences(runs[r], titles);
        if (all.empty()) continue;
        Line fresh{line(all), "", {labels[r]}};
        for (const Absent& absent : all) {
            fresh.reasons += "<li>" + escape_html(absent.what + ": " + absent.reason) + "</li>\n";
        }
        const auto same = std::ranges::find_if(lines, [&](const Line& known) {
            return known.text == fresh.text && known.reasons == fresh.reasons;
        });
        if (same != lines.end()) {
            same->whose.push_back(labels[r]);
        } else {
            lines.push_back(std::move(fresh));
        }
    }
    std::string out;
    for (const Line& line : lines) {
        std::string whose;
        for (const std::string& label : line.whose) {
            if (!whose.empty()) whose.append(", ");
            whose.append(label);
        }
        whose.append(": ");
        out += "<details class=\"missing\"><summary>" +
               escape_html((runs.size() > 1 ? whose : "") + line.text) + "</summary><ul>\n" +
               line.reasons + "</ul></details>\n";
    }
    return out;
}

}  // namespace grainfield::report
