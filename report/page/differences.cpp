#include "report/page/differences.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>

#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr std::size_t most_pairs = 40;
constexpr double remarkable = 3;    // standard errors
constexpr double same_wave = 1e-4;  // relative: k of two boxes of one size
constexpr std::size_t least_shells = 8;

bool same(const std::optional<ControlValue>& a, const std::optional<ControlValue>& b) {
    if (!a || !b || a->parameter != b->parameter || a->unit != b->unit) return false;
    return std::abs(a->value - b->value) <= 1e-6 * std::max(std::abs(a->value), std::abs(b->value));
}

bool is_known(const Measurement& m) {
    return m.value && m.error && std::isfinite(*m.value) && std::isfinite(*m.error) && *m.error > 0;
}

// The measurement of the other run with the same name and unit, if it is known there too.
const Measurement* counterpart(const Results& run, const std::string& observable,
                               const Measurement& m) {
    const ObservableResult* other = run.find(observable);
    const Measurement* found = other == nullptr ? nullptr : other->find_measurement(m.name);
    return found != nullptr && is_known(*found) && found->unit == m.unit ? found : nullptr;
}

// Whether the shells of a spectrum are independent, so that the mean square of the differences
// tells whether two of them agree: waves that a periodic box has, and modes between walls. Plane
// waves between walls overlap, as do neighbouring points of other curves.
bool has_independent_shells(const Curve& curve, const Results& run) {
    const auto is_called = [&](const char* name) { return curve.name == name; };
    if (!run.box.is_periodic()) return is_called("sk_neumann");
    return is_called("sk") || is_called("s4") || is_called("sk_order");
}

// The curve of the other run, if both are of independent shells and were measured in the same way,
// which their title says.
const Curve* same_spectrum(const Curve& curve, const std::string& observable, const Results& run,
                           const Results& other_run) {
    const ObservableResult* other = other_run.find(observable);
    const Curve* found = other == nullptr ? nullptr : other->find_curve(curve.name);
    if (found == nullptr || found->title != curve.title) return nullptr;
    const bool are_judged =
        has_independent_shells(curve, run) && has_independent_shells(*found, other_run);
    return are_judged ? found : nullptr;
}

TableCell difference_cell(const Measurement& a, const Measurement& b) {
    const double difference = *a.value - *b.value;
    const double error = std::hypot(*a.error, *b.error);
    TableCell cell;
    cell.value = difference / error;
    cell.text = fmt::format("{:+.1f}", cell.value);
    cell.failed = std::abs(cell.value) > remarkable;
    return cell;
}

const Column* find_known(const Curve& curve, const char* column) {
    const Column* found = curve.find(column);
    return found != nullptr && !found->values.empty() ? found : nullptr;
}

struct SpectrumDifference {
    double mean_square = 0;  // of the differences in units of their errors
    std::size_t shells = 0;  // that have an error in both
    std::size_t in_both = 0;
};

std::optional<SpectrumDifference> spectrum_difference(const Curve& a, const Curve& b) {
    SpectrumDifference all;
    const Column* k[] = {find_known(a, "k"), find_known(b, "k")};
    const Column* s[] = {find_known(a, "s"), find_known(b, "s")};
    const Column* error[] = {find_known(a, "s_err"), find_known(b, "s_err")};
    for (const auto& columns : {k, s, error}) {
        if (columns[0] == nullptr || columns[1] == nullptr) return std::nullopt;
    }
    const bool same_units = k[0]->unit == k[1]->unit && s[0]->unit == s[1]->unit;
    if (!same_units || a.find("n") == nullptr) return std::nullopt;  // a fit has no shells
    const auto is_known = [](double e) { return std::isfinite(e) && e > 0; };
    std::size_t j = 0;
    for (std::size_t i = 0; i < k[0]->values.size(); ++i) {
        const double here = k[0]->values[i];
        while (j < k[1]->values.size() && k[1]->values[j] < here * (1 - same_wave)) ++j;
        if (j == k[1]->values.size()) break;
        if (k[1]->values[j] > here * (1 + same_wave)) continue;
        ++all.in_both;
        if (!is_known(error[0]->values[i]) || !is_known(error[1]->values[j])) continue;
        const double difference = (s[0]->values[i] - s[1]->values[j]) /
                                  std::hypot(error[0]->values[i], error[1]->values[j]);
        all.mean_square += difference * difference;
        ++all.shells;
    }
    if (all.shells < least_shells) return std::nullopt;
    all.mean_square /= static_cast<double>(all.shells);
    return all;
}

// Errors of few blocks are widened by Student's factor, so that the mean square is 1 at most.
TableCell spectrum_cell(const SpectrumDifference& difference) {
    const auto shells = static_cast<double>(difference.shells);
    TableCell cell;
    cell.value = std::sqrt(difference.mean_square);
    const std::string of_all = difference.shells < difference.in_both
                                   ? fmt::format(" of {}", difference.in_both)
                                   : std::string();
    cell.text = fmt::format("{:.1f} ({}{} shells)", cell.value, difference.shells, of_all);
    cell.failed = difference.mean_square > 1 + remarkable * std::sqrt(2 / shells);
    return cell;
}

struct Rows {
    std::vector<Table::Row> list;
    std::map<std::string, std::size_t> place;

    Table::Row& at(const std::string& name, std::size_t columns) {
        const auto [found, fresh] = place.try_emplace(name, list.size());
        if (fresh) list.push_back({name, std::vector<TableCell>(columns)});
        return list[found->second];
    }
};

// "0.1.0 (A, B)" for each value; empty if all agree.
std::string groups(const std::vector<std::string>& labels,
                   const std::function<std::string(std::size_t)>& value) {
    std::map<std::string, std::vector<std::string>> who;
    for (std::size_t r = 0; r < labels.size(); ++r) {
        if (const std::string v = value(r); !v.empty()) who[v].push_back(labels[r]);
    }
    if (who.size() < 2) return "";
    std::string text;
    for (const auto& [v, names] : who) {
        text += fmt::format("{}{} ({}", text.empty() ? "" : ", ", v, names.front());
        if (names.size() > 1) text += fmt::format(" and {} more", names.size() - 1);
        text += ")";
    }
    return text;
}

bool has_any_error(const Results& run) {
    return std::ranges::any_of(run.observables, [](const ObservableResult& observable) {
        return std::ranges::any_of(observable.measurements, is_known);
    });
}

// Whether a number or a curve of the run has time in its unit.
bool has_times(const Results& run) {
    const auto is_timed = [](const Unit& unit) { return unit.power(BaseUnit::time) != 0; };
    return std::ranges::any_of(run.observables, [&](const ObservableResult& observable) {
        return std::ranges::any_of(observable.measurements, is_timed, &Measurement::unit) ||
               std::ranges::any_of(observable.curves, [&](const Curve& curve) {
                   return std::ranges::any_of(curve.columns, is_timed, &Column::unit);
               });
    });
}

const char* length_unit(const RunIdentity& identity) {
    if (identity.role == RunRole::critical_point) return "";
    return identity.is_field() ? "l" : "a";
}

}  // namespace

std::vector<RunPair> pairs_of(const std::vector<Results>& runs,
                              const std::vector<RunIdentity>& identities) {
    std::vector<std::size_t> members;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (identities[r].role == RunRole::run) members.push_back(r);
    }
    if (members.size() == 2) return {{members[0], members[1]}};
    std::vector<RunPair> pairs;
    for (std::size_t i = 0; i < members.size(); ++i) {
        for (std::size_t j = i + 1; j < members.size(); ++j) {
            const RunIdentity& a = identities[members[i]];
            const RunIdentity& b = identities[members[j]];
            const auto& rate_a = runs[members[i]].source.frame_rate;
            const auto& rate_b = runs[members[j]].source.frame_rate;
            const bool rates_differ =
                rate_a && rate_b && std::abs(*rate_a - *rate_b) > 0.01 * std::abs(*rate_a);
            // Fields at one ν but of other dimension or b are other models.
            const bool models_differ = a.is_field() || b.is_field();
            const bool match = !models_differ && a.origin != b.origin &&
                               same(a.control, b.control) && !rates_differ;
            if (match) pairs.push_back({members[i], members[j]});
        }
    }
    return pairs;
}

std::optional<Table> differences(const std::vector<Results>& runs,
                                 const std::vector<std::string>& labels,
                                 const std::vector<RunIdentity>& identities,
                                 const std::vector<ObservableTitles>& titles) {
    std::vector<RunPair> pairs = pairs_of(runs, identities);
    if (pairs.size() > most_pairs) pairs.resize(most_pairs);
    Table table;
    table.name = differences_name;
    table.title = "Differences in units of their error";
    table.note =
        "First run less second, over the root of the sum of both squared errors, which are taken "
        "as independent: two analyses of the same frames share most of theirs. Beyond 3 it stands "
        "out.";
    Rows rows;
    bool has_spectra = false;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const auto [first, second] = pairs[p];
        table.columns.push_back(
            {fmt::format("pair_{}", p + 1), labels[first] + " less " + labels[second], "", false});
        for (const ObservableResult& observable : runs[first].observables) {
            for (const Measurement& m : observable.measurements) {
                if (!is_known(m)) continue;
                const Measurement* other = counterpart(runs[second], observable.name, m);
                if (other == nullptr) continue;
                const std::string name =
                    clean_text(observable_title(titles, observable.name)) + ": " +
                    clean_text(quantity_title(titles, observable.name, m.name));
                rows.at(name, pairs.size()).cells[p] = difference_cell(m, *other);
            }
            for (const Curve& curve : observable.curves) {
                const Curve* other =
                    same_spectrum(curve, observable.name, runs[first], runs[second]);
                if (other == nullptr) continue;
                const auto difference = spectrum_difference(curve, *other);
                if (!difference) continue;
                has_spectra = true;
                rows.at(clean_text(curve.title) + ": root mean square", pairs.size()).cells[p] =
                    spectrum_cell(*difference);
            }
        }
    }
    if (rows.list.empty()) return std::nullopt;
    if (has_spectra) {
        table.note +=
            " Of a spectrum it is the root mean square over the n shells of k that both have "
            "with an error: about 1 where independent runs agree. "
            "It stands out where its square is above 1 + 3 √(2/n).";
    }
    table.rows = std::move(rows.list);
    return table;
}

std::string time_mismatch(const std::vector<Results>& runs,
                          const std::vector<std::string>& labels) {
    std::string time = groups(labels, [&](std::size_t r) {
        return has_times(runs[r]) ? std::string(typeset_text(runs[r].source.time_unit))
                                  : std::string();
    });
    if (time.empty()) return time;
    const auto any = [&](TimeUnit unit) {
        return std::ranges::any_of(
            runs, [&](const Results& run) { return run.source.time_unit == unit; });
    };
    std::string cure;
    if (any(TimeUnit::frame)) cure = "track the film with --fps for seconds";
    if (any(TimeUnit::sqrt_a_over_g)) {
        cure += cure.empty() ? "" : ", and ";
        cure += "give --sphere-mm, the true diameter in mm, for simulations in seconds";
    }
    return fmt::format("times in different units: {}; {}", time, cure);
}

std::vector<std::string> mismatches(const std::vector<Results>& runs,
                                    const std::vector<std::string>& labels,
                                    const std::vector<RunIdentity>& identities) {
    std::vector<std::string> out;
    const auto version = groups(labels, [&](std::size_t r) { return runs[r].record.version; });
    if (!version.empty()) out.push_back("made by different versions of the program: " + version);
    const auto length = groups(labels, [&](std::size_t r) { return length_unit(identities[r]); });
    if (!length.empty()) {
        out.push_back("lengths in different units share axes, compare shapes and not scales: " +
                      length);
    }
    if (std::string time = time_mismatch(runs, labels); !time.empty()) out.push_back(time);
    const auto dimension = groups(labels, [&](std::size_t r) {
        return identities[r].role == RunRole::critical_point
                   ? std::string()
                   : fmt::format("{} dimension{}", identities[r].dimension,
                                 identities[r].dimension == 1 ? "" : "s");
    });
    if (!dimension.empty()) out.push_back("runs of different dimension: " + dimension);
    std::string without;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (runs[r].observables.empty() || has_any_error(runs[r])) continue;
        without += (without.empty() ? "" : ", ") + labels[r];
    }
    if (!without.empty() && runs.size() > 1) {
        out.push_back("without any error, so that differences cannot be judged: " + without);
    }
    return out;
}

}  // namespace grainfield::report
