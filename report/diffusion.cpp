#include "report/diffusion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>

namespace grainfield::report {

namespace {

constexpr double most_apart = 0.1;    // of an exponent from that of diffusion
constexpr double large_offset = 0.1;  // of the MSD at the start of the decade
// The slope of the MSD is that of t^0.8 or steeper. A cage of t^0.5 gives 0.5.
constexpr double least_straight = 0.8;
constexpr double most_uncertain = 0.5;  // error of D over D
constexpr std::size_t least_rows = 6;

struct Rows {
    std::vector<double> t, msd;
};

Rows rows_of(const ObservableResult& msd, const char* name, const std::string& phase) {
    Rows rows;
    const Curve* curve = msd.find_curve(name);
    const Column* t = curve == nullptr ? nullptr : curve->find("t");
    const Column* m = curve == nullptr ? nullptr : curve->find("msd");
    if (t == nullptr || m == nullptr) return rows;
    const auto words = curve->text_columns.find("phase");
    if (words == curve->text_columns.end()) return rows;
    const std::size_t n = std::min({t->values.size(), m->values.size(), words->second.size()});
    for (std::size_t i = 0; i < n; ++i) {
        if (words->second[i] != phase || !std::isfinite(m->values[i])) continue;
        rows.t.push_back(t->values[i]);
        rows.msd.push_back(m->values[i]);
    }
    return rows;
}

struct Half {
    double middle = 0;  // mean lag
    double slope = 0;
};

Half line_through(const Rows& rows, std::size_t begin, std::size_t end) {
    const auto n = static_cast<double>(end - begin);
    double t = 0, m = 0, tt = 0, tm = 0;
    for (std::size_t i = begin; i < end; ++i) {
        t += rows.t[i] / n;
        m += rows.msd[i] / n;
    }
    for (std::size_t i = begin; i < end; ++i) {
        tt += (rows.t[i] - t) * (rows.t[i] - t);
        tm += (rows.t[i] - t) * (rows.msd[i] - m);
    }
    return {t, tt > 0 ? tm / tt : 0};
}

// Exponent p of MSD = A t^p + c by its slope, A p t^(p − 1), in the halves of the fitted lags: free
// of c. Empty: too few lags.
std::optional<double> exponent_without_offset(const Rows& all, double first, double last) {
    Rows rows;
    for (std::size_t i = 0; i < all.t.size(); ++i) {
        if (all.t[i] < first || all.t[i] > last) continue;
        rows.t.push_back(all.t[i]);
        rows.msd.push_back(all.msd[i]);
    }
    if (rows.t.size() < least_rows || !std::ranges::is_sorted(rows.t)) return std::nullopt;
    const double middle = std::sqrt(first * last);
    const auto split =
        static_cast<std::size_t>(std::ranges::upper_bound(rows.t, middle) - rows.t.begin());
    if (split < 2 || rows.t.size() - split < 2) return std::nullopt;
    const Half early = line_through(rows, 0, split);
    const Half late = line_through(rows, split, rows.t.size());
    if (!(early.slope > 0)) return std::nullopt;
    if (!(late.slope > 0)) return 0;
    return 1 + std::log(late.slope / early.slope) / std::log(late.middle / early.middle);
}

bool is_known(const Measurement* m) {
    return m != nullptr && m->value && std::isfinite(*m->value);
}

// Whether the exponent is low by an offset, and not by a cage.
bool is_offset(const ObservableResult& msd, const std::string& phase) {
    const OptionValue* given = msd.find_option("localisation");
    if (given != nullptr && std::holds_alternative<double>(*given)) return false;
    const Measurement* c = msd.find_measurement("offset_" + phase);
    const Measurement* d = msd.find_measurement("d_" + phase);
    if (!is_known(c) || !is_known(d) || !(*d->value > 0)) return false;
    if (d->error && *d->error > most_uncertain * *d->value) return false;
    const Rows line = rows_of(msd, "msd_fit", phase);
    if (line.t.empty() || !(*c->value > large_offset * line.msd.front())) return false;
    const auto straight =
        exponent_without_offset(rows_of(msd, "msd", phase), line.t.front(), line.t.back());
    return straight && *straight >= least_straight;
}

}  // namespace

DiffusionVerdict judge_diffusion(const ObservableResult& msd, const std::string& phase) {
    const Measurement* exponent = msd.find_measurement("exponent_" + phase);
    if (!is_known(exponent)) return {};
    const double value = *exponent->value;
    const double error = exponent->error.value_or(0);
    const auto grows = [&] {
        std::string text = fmt::format("the MSD grows as t^{:.2f}", value);
        if (error > 0) text += fmt::format(" (± {:.2g})", error);
        return text;
    };
    if (value - error > 1 + most_apart) return {false, grows() + ": flight, not yet diffusion"};
    if (value + error >= 1 - most_apart) return {};
    if (is_offset(msd, phase)) return {true, "offset not removed"};
    return {false, grows() + ": a cage, not yet diffusion"};
}

}  // namespace grainfield::report
