#include "report/possible_numbers.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace grainfield::report {

namespace {

constexpr double most_diffusive = 1.5;  // exponent of the MSD; 1: diffusion, 2: free flight

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

// [time unit]; 0: not known
double length_of_film(const Results& run) {
    const double rate = run.source.frame_rate.value_or(0);
    return rate > 0 ? static_cast<double>(run.frames) / rate : 0;
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

void withhold_flight(ObservableResult& msd) {
    constexpr std::string_view prefix = "exponent_";
    std::vector<std::pair<std::string, double>> in_flight;
    for (const Measurement& m : msd.measurements) {
        if (m.name.starts_with(prefix) && m.value && *m.value > most_diffusive) {
            in_flight.emplace_back(m.name.substr(prefix.size()), *m.value);
        }
    }
    for (const auto& [phase, exponent] : in_flight) {
        for (Measurement& m : msd.measurements) {
            if (m.name != "d_" + phase && m.name != "offset_" + phase) continue;
            withhold(m,
                     fmt::format("the MSD grows as t^{:.2f}: flight, not yet diffusion", exponent));
        }
        erase_line(msd, phase);
    }
}

}  // namespace

Results with_possible_numbers(Results run) {
    for (ObservableResult& observable : run.observables) {
        if (run.frames == 1 && !run.identity.is_field()) withhold_of_one_frame(observable);
        if (observable.name == "phase") withhold_long_window(observable, length_of_film(run));
        if (observable.name == "msd") withhold_flight(observable);
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
