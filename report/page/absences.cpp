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

/// What some runs lack, for one reason.
struct Lacking {
    Absent absent;
    std::vector<std::size_t> runs;
};

constexpr std::size_t most_named = 4;

// "S₀, S₁, k_pp and 9 more".
std::string listed(const std::vector<Lacking>& all, bool one_frame, std::size_t most) {
    std::vector<std::string> names;
    for (const Lacking& lacking : all) {
        const std::string& what = lacking.absent.what;
        if (lacking.absent.one_frame != one_frame) continue;
        if (std::ranges::find(names, what) == names.end()) names.push_back(what);
    }
    // One left over is named as well.
    const std::size_t named = names.size() > most + 1 ? most : names.size();
    std::string text;
    for (std::size_t i = 0; i < named; ++i) text += (i > 0 ? ", " : "") + names[i];
    if (named < names.size()) text += " and " + std::to_string(names.size() - named) + " more";
    return text;
}

std::string line(const std::vector<Lacking>& all) {
    const std::string of_one = listed(all, true, all.size());
    const std::string others = listed(all, false, most_named);
    std::string text;
    if (!of_one.empty()) text = "Not possible with one frame: " + of_one + ".";
    if (!others.empty()) {
        if (!text.empty()) text.append(" ");
        text.append("Not measured: ").append(others).append(".");
    }
    return text;
}

// "A, B"; nothing where all of several runs, or the only one, are meant.
std::string names_of(const std::vector<std::size_t>& runs, const std::vector<std::string>& labels) {
    if (runs.size() == labels.size()) return "";
    std::string names;
    for (const std::size_t r : runs) names += (names.empty() ? "" : ", ") + labels[r];
    return names + ": ";
}

}  // namespace

std::vector<Absent> absences(const Results& run, const std::vector<ObservableTitles>& titles) {
    std::vector<Absent> all;
    const auto add = [&](const std::string& what, const std::string& reason) {
        const std::string why = clean_text(reason.empty() ? "no value" : reason);
        all.push_back({inside_sentence(clean_text(what)), why, blames_one_frame(run, why)});
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
        // One reason of several numbers is said once, under the name of the whole: that there is
        // one frame, or that of more than half of the numbers, as where there is no fit.
        const auto of_one = std::ranges::count_if(observable.measurements, [&](const auto& m) {
            return is_missing(m) && blames_one_frame(run, m.reason);
        });
        const auto is_of_most = [&](const Measurement& m) {
            const auto same = std::ranges::count_if(
                observable.measurements,
                [&](const auto& other) { return is_missing(other) && other.reason == m.reason; });
            return !is_drawn && 2 * same > size && same > 1;
        };
        bool said_of_one_frame = false;
        bool said_of_most = false;
        for (const Measurement& m : observable.measurements) {
            if (!is_missing(m)) continue;
            const std::string own = quantity_title(titles, observable.name, m.name);
            if (of_one > 1 && blames_one_frame(run, m.reason)) {
                if (!std::exchange(said_of_one_frame, true)) add(is_drawn ? own : title, m.reason);
            } else if (is_of_most(m)) {
                if (!std::exchange(said_of_most, true)) add(title, m.reason);
            } else {
                add(own, m.reason);
            }
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
    std::vector<Lacking> all;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (const Absent& absent : absences(runs[r], titles)) {
            const auto known = std::ranges::find_if(all, [&](const Lacking& lacking) {
                return lacking.absent.what == absent.what && lacking.absent.reason == absent.reason;
            });
            if (known == all.end()) {
                all.push_back({absent, {r}});
            } else if (known->runs.back() != r) {
                known->runs.push_back(r);
            }
        }
    }
    if (all.empty()) return "";
    std::string reasons;
    for (std::size_t i = 0; i < all.size();) {
        const auto& [absent, whose] = all[i];
        std::string what = absent.what;
        // What follows for the same reason stands in the same line.
        for (++i; i < all.size() && all[i].runs == whose && all[i].absent.reason == absent.reason;
             ++i)
            what += ", " + all[i].absent.what;
        reasons +=
            "<li>" + escape_html(names_of(whose, labels) + what + ": " + absent.reason) + "</li>\n";
    }
    return "<details class=\"missing\"><summary>" + escape_html(line(all)) + "</summary><ul>\n" +
           reasons + "</ul></details>\n";
}

}  // namespace grainfield::report
