#include "report/possible_numbers.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "report/diffusion.h"

namespace grainfield::report {

namespace {

void withhold(Measurement& m, const std::string& reason) {
    if (!m.value) return;
    m.value.reset();
    m.error.reset();
    m.samples = 0;
    m.reason = reason;
}

bool is_of_phases(const std::string& name) {
    return name != "largest_cluster" && name != "cluster_size";
}

bool is_of_fit(const ObservableResult& observable, const std::string& name) {
    if (observable.name == "fit" || observable.name == "synthetic") return true;
    if (observable.name == "sk") return name.ends_with("lowest_k") && name != "lowest_k";
    return observable.name == "s4" && name != "lowest_k";
}

void withhold_of_one_frame(ObservableResult& observable) {
    for (Measurement& m : observable.measurements) {
        if (observable.name == "phase" && is_of_phases(m.name)) {
            withhold(m, "one frame: phases are told by the average over a time");
        }
        if (is_of_fit(observable, m.name)) {
            withhold(m, "one frame: a single sample of a few waves");
        }
    }
    std::erase_if(observable.curves, [](const Curve& curve) { return curve.name == "fit"; });
}

void withhold_long_window(ObservableResult& phase, double film) {
    for (Measurement& m : phase.measurements) {
        if (m.name != "averaging_time" || !m.value || film <= 0 || *m.value <= film) continue;
        withhold(m, "longer than the film: phases are averages over all of it");
    }
}

// The fitted line of one phase goes with the number.
void erase_line(ObservableResult& msd, const std::string& phase) {
    for (Curve& curve : msd.curves) {
        const auto words = curve.text_columns.find("phase");
        if (curve.name != "msd_fit" || words == curve.text_columns.end()) continue;
        for (std::size_t i = words->second.size(); i-- > 0;) {
            if (words->second[i] != phase) continue;
            const auto at = static_cast<std::ptrdiff_t>(i);
            for (Column& column : curve.columns) {
                if (i < column.values.size()) column.values.erase(column.values.begin() + at);
            }
            words->second.erase(words->second.begin() + at);
        }
    }
}

void withhold_what_is_no_diffusion(ObservableResult& msd) {
    constexpr std::string_view prefix = "exponent_";
    std::vector<std::pair<std::string, std::string>> reasons;
    for (const Measurement& m : msd.measurements) {
        if (!m.name.starts_with(prefix)) continue;
        std::string phase = m.name.substr(prefix.size());
        const DiffusionVerdict said = judge_diffusion(msd, phase);
        if (!said.is_diffusion) reasons.emplace_back(std::move(phase), said.words);
    }
    for (const auto& [phase, reason] : reasons) {
        for (Measurement& m : msd.measurements) {
            if (m.name == "d_" + phase || m.name == "offset_" + phase) withhold(m, reason);
        }
        erase_line(msd, phase);
    }
}

constexpr double most_uncertain = 0.5;  // of a variance from S(k), relative

// Windows of one box: which of them are known, and what makes the others uncertain.
struct BoxRows {
    std::string side;
    std::size_t all = 0, known = 0;
    std::size_t assumed = 0;  ///< of the others: by what lies beyond the measured wavevectors
};

std::vector<BoxRows> rows_by_box(const Curve& curve, const std::vector<std::string>& sides) {
    const std::vector<double>& variance = curve.find("variance")->values;
    const std::vector<double>& error = curve.find("err")->values;
    const Column* beyond = curve.find("beyond");
    std::vector<BoxRows> boxes;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        if (boxes.empty() || boxes.back().side != sides[i]) boxes.push_back({.side = sides[i]});
        ++boxes.back().all;
        if (error[i] < most_uncertain * variance[i]) {
            ++boxes.back().known;
        } else if (beyond != nullptr && std::abs(beyond->values[i]) > 0.5 * error[i]) {
            ++boxes.back().assumed;
        }
    }
    return boxes;
}

// Rows of a curve of which `keep` holds.
void keep_rows(Curve& curve, const std::vector<bool>& keep) {
    const auto kept = [&keep]<class T>(const std::vector<T>& all) {
        std::vector<T> some;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (keep[i]) some.push_back(all[i]);
        }
        return some;
    };
    for (Column& column : curve.columns) column.values = kept(column.values);
    for (auto& [name, words] : curve.text_columns) words = kept(words);
}

bool is_whole(const Curve& curve) {
    const auto sides = curve.text_columns.find("side");
    return sides != curve.text_columns.end() && curve.find("variance") != nullptr &&
           curve.find("err") != nullptr &&
           std::ranges::all_of(curve.columns, [&](const Column& column) {
               return column.values.size() == sides->second.size();
           });
}

void withhold_uncertain_boxes(ObservableResult& synthetic) {
    for (Curve& curve : synthetic.curves) {
        if (curve.name != "synthetic" || !is_whole(curve)) continue;
        const std::vector<std::string> sides = curve.text_columns.at("side");
        const std::vector<double>& variance = curve.find("variance")->values;
        const std::vector<double>& error = curve.find("err")->values;
        std::vector<bool> keep(sides.size());
        for (std::size_t i = 0; i < sides.size(); ++i) {
            keep[i] = error[i] < most_uncertain * variance[i];
        }
        for (const BoxRows& box : rows_by_box(curve, sides)) {
            if (2 * box.known >= box.all) continue;
            const bool is_cut = 2 * box.assumed > box.all - box.known;
            for (std::size_t i = 0; i < sides.size(); ++i) {
                if (sides[i] == box.side) keep[i] = false;
            }
            synthetic.measurements.push_back(
                {"box_" + box.side, "a", std::nullopt, std::nullopt, 0,
                 is_cut ? "what lies beyond the measured wavevectors decides it: a larger sk.k-max "
                          "measures more of them"
                        : "errors above half of it: the run is too short"});
        }
        keep_rows(curve, keep);
    }
    std::erase_if(synthetic.curves, [](const Curve& curve) {
        return curve.name == "synthetic" &&
               std::ranges::all_of(curve.columns,
                                   [](const Column& column) { return column.values.empty(); });
    });
}

}  // namespace

double length_of_film(const Results& run) {
    const ObservableResult* lengths = run.find("lengths");
    const Measurement* length =
        lengths == nullptr ? nullptr : lengths->find_measurement("film_length");
    if (length != nullptr && length->value) return *length->value;
    const double rate = run.source.frame_rate.value_or(0);
    return rate > 0 ? static_cast<double>(run.frames) / rate : 0;
}

Results with_possible_numbers(Results run) {
    for (ObservableResult& observable : run.observables) {
        if (run.frames == 1 && !run.identity.is_field()) withhold_of_one_frame(observable);
        if (observable.name == "phase") withhold_long_window(observable, length_of_film(run));
        if (observable.name == "msd") withhold_what_is_no_diffusion(observable);
        if (observable.name == "synthetic") withhold_uncertain_boxes(observable);
        for (Measurement& m : observable.measurements) {
            if (m.samples < 2) m.samples = 0;
        }
    }
    return run;
}

void leave_out_incomparable(std::vector<Results>& runs) {
    const auto is_raw = [](const Results& run) {
        return run.frames == 1 && !run.box.is_periodic() && !run.identity.is_field();
    };
    const auto has_spectrum = [&](const Results& run) {
        const ObservableResult* sk = run.find("sk");
        return sk != nullptr && sk->find_curve("sk") != nullptr && !is_raw(run);
    };
    if (std::ranges::none_of(runs, has_spectrum)) return;
    for (Results& run : runs) {
        if (!is_raw(run)) continue;
        for (ObservableResult& observable : run.observables) {
            if (observable.name != "sk" && observable.name != "s4") continue;
            observable.curves.clear();
            observable.reason = "one frame: its S(k) is that of the walls, orders above the others";
        }
    }
}

}  // namespace grainfield::report
