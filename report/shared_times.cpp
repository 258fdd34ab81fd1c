#include "report/shared_times.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/lab_units.h"

namespace grainfield::report {

namespace {

constexpr double same_diameter = 0.01;  // relative, the rounding of what a lab writes down

bool has_particles(const Results& run) {
    return run.identity.role == RunRole::run && !run.identity.is_field();
}

bool is_in(const Results& run, TimeUnit unit) {
    return has_particles(run) && run.source.time_unit == unit;
}

std::optional<double> stated_mm(const Results& run) {
    const ObservableResult* lengths = run.find("lengths");
    const Measurement* m = lengths == nullptr ? nullptr : lengths->find_measurement("sphere_mm");
    if (m == nullptr || !m->value || !(*m->value > 0)) return std::nullopt;
    return m->value;
}

// Nothing if two of them contradict each other.
std::optional<double> mm_of_films(const std::vector<Results>& runs) {
    std::optional<double> shared;
    for (const Results& run : runs) {
        const auto own = stated_mm(run);
        if (!is_in(run, TimeUnit::second) || !own) continue;
        if (shared && std::abs(*own / *shared - 1) > same_diameter) return std::nullopt;
        if (!shared) shared = own;
    }
    return shared;
}

void convert(Results& run, double seconds) {
    for (ObservableResult& observable : run.observables) {
        for (Measurement& m : observable.measurements) {
            const double factor = std::pow(seconds, m.unit.power(BaseUnit::time));
            if (m.value) *m.value *= factor;
            if (m.error) *m.error *= factor;
        }
        for (Curve& curve : observable.curves) {
            for (Column& column : curve.columns) {
                const int power = column.unit.power(BaseUnit::time);
                if (power == 0) continue;
                const double factor = std::pow(seconds, power);
                for (double& value : column.values) value *= factor;
            }
        }
    }
    if (run.source.frame_rate) *run.source.frame_rate /= seconds;
    if (run.source.vibration_frequency) *run.source.vibration_frequency /= seconds;
    for (Preview& preview : run.previews) preview.snapshot.time *= seconds;
    run.source.time_unit = TimeUnit::second;
}

}  // namespace

std::string share_seconds(std::vector<Results>& runs, std::optional<double> sphere_mm) {
    const auto is_film = [](const Results& run) { return is_in(run, TimeUnit::second); };
    if (std::ranges::none_of(runs, is_film)) return {};
    const std::optional<double> of_films = mm_of_films(runs);
    std::string said;
    for (Results& run : runs) {
        if (!is_in(run, TimeUnit::sqrt_a_over_g)) continue;
        const std::optional<double> own = sphere_mm ? sphere_mm : stated_mm(run);
        const std::optional<double> mm = own ? own : of_films;
        if (!mm) continue;
        const double seconds = seconds_of_time_unit(*mm);
        convert(run, seconds);
        const std::string one =
            fmt::format("√(a/g) = {:.3g} ms for a = {:g} mm", 1e3 * seconds, *mm);
        if (said.find(one) == std::string::npos) said += (said.empty() ? "" : ", ") + one;
    }
    return said.empty() ? said : "Simulations in seconds: " + said + ".";
}

}  // namespace grainfield::report
