#include "analysis/motion/msd_result.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "analysis/statistics/blocks.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 3> names{"all", "liquid", "solid"};

// The mean of each lag, with group `without` left out (none if beyond the last).
std::vector<double> mean_without(const MsdTable::Series& series, std::size_t without) {
    const std::size_t lags = series.sum.empty() ? 0 : series.sum.front().size();
    std::vector<double> mean(lags, undefined);
    for (std::size_t l = 0; l < lags; ++l) {
        double sum = 0;
        double pairs = 0;
        for (std::size_t g = 0; g < series.sum.size(); ++g) {
            if (g == without) continue;
            sum += series.sum[g][l];
            pairs += series.pairs[g][l];
        }
        if (pairs > 0) mean[l] = sum / pairs;
    }
    return mean;
}

struct Line {
    double slope = undefined;
    double intercept = undefined;
    int points = 0;
};

Line fit_line(const std::vector<double>& x, const std::vector<double>& y,
              const std::vector<double>& weight) {
    double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    Line line;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isfinite(y[i]) || !std::isfinite(x[i])) continue;
        sw += weight[i];
        sx += weight[i] * x[i];
        sy += weight[i] * y[i];
        ++line.points;
    }
    if (line.points < 3) return line;
    const double mx = sx / sw;
    const double my = sy / sw;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isfinite(y[i]) || !std::isfinite(x[i])) continue;
        sxx += weight[i] * (x[i] - mx) * (x[i] - mx);
        sxy += weight[i] * (x[i] - mx) * (y[i] - my);
    }
    if (sxx > 0) {
        line.slope = sxy / sxx;
        line.intercept = my - line.slope * mx;
    }
    return line;
}

struct Fits {
    double diffusion = undefined;
    double offset = undefined;
    double first = undefined;  // of the lags that were fitted
    double last = undefined;
    double exponent = undefined;
};

// What is known about the positions.
struct Positions {
    std::optional<double> exposure, localisation;

    explicit Positions(const MsdTable& table)
        : exposure(table.exposure), localisation(table.localisation) {}
};

// D from MSD − 4 σ² = 4 D (t − t_e/3), and the offset that follows from it.
void fit_through_offset(const std::vector<double>& t, const std::vector<double>& m,
                        const std::vector<double>& weight, double exposure, double localisation,
                        Fits& fits) {
    double xx = 0;
    double xy = 0;
    int points = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
        if (!std::isfinite(m[i]) || t[i] < exposure) continue;
        const double x = t[i] - exposure / 3;
        xx += weight[i] * x * x;
        xy += weight[i] * x * (m[i] - 4 * localisation * localisation);
        ++points;
    }
    fits.diffusion = points >= 3 ? xy / xx / 4 : undefined;
    fits.offset = 4 * localisation * localisation - 4.0 / 3 * fits.diffusion * exposure;
}

Fits fit_last_decade(const std::vector<double>& time, const std::vector<double>& msd,
                     const Positions& positions) {
    double last = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (std::isfinite(msd[i]) && std::isfinite(time[i])) last = std::max(last, time[i]);
    }
    const double sigma = positions.localisation.value_or(0);
    const double noise = 4 * sigma * sigma;
    std::vector<double> t, m, relative, log_t, log_m, one;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (!std::isfinite(msd[i]) || !(time[i] >= 0.1 * last) || time[i] <= 0) continue;
        if (time[i] < positions.exposure.value_or(0)) continue;  // the formula is for t ≥ t_e
        t.push_back(time[i]);
        m.push_back(msd[i]);
        relative.push_back(1 / (time[i] * time[i]));
        log_t.push_back(std::log(time[i]));
        const double moved = msd[i] - noise;
        log_m.push_back(moved > 0 ? std::log(moved) : undefined);
        one.push_back(1);
    }
    const Line line = fit_line(t, m, relative);
    Fits fits;
    fits.diffusion = line.slope / 4;
    fits.offset = line.intercept;
    if (positions.exposure && positions.localisation) {
        fit_through_offset(t, m, relative, *positions.exposure, *positions.localisation, fits);
    }
    fits.exponent = fit_line(log_t, log_m, one).slope;
    if (!t.empty()) std::tie(fits.first, fits.last) = std::pair(t.front(), t.back());
    return fits;
}

Measurement fitted(const char* what, const char* unit, const std::string& phase, double value,
                   const std::vector<double>& left_out, double samples, const std::string& note) {
    Measurement m{std::string(what) + "_" + phase, unit, std::nullopt, std::nullopt, 0, note};
    if (!std::isfinite(value)) {
        m.reason =
            "fewer than three lags with data in the last decade of lag times, none shorter than "
            "the exposure";
        return m;
    }
    m.value = value;
    m.error = student_jackknife_error(left_out);
    m.samples = samples;
    if (!m.error) {
        m.reason = (note.empty() ? "" : note + "; ") +
                   "particles in fewer than four groups of the jackknife: no error";
    }
    if (m.error && !(*m.error > 0)) {
        m.error.reset();
        m.reason = "all particles move alike: no error from their scatter";
    }
    return m;
}

// What the offset says about the positions: σ where the exposure is given, the exposure where σ
// is.
double hidden(const Fits& fits, const Positions& positions) {
    if (positions.exposure) {
        return (fits.offset + 4.0 / 3 * fits.diffusion * *positions.exposure) / 4;  // σ²
    }
    const double square = *positions.localisation * *positions.localisation;
    return 3 * (4 * square - fits.offset) / (4 * fits.diffusion);
}

void add_hidden(const Fits& fits, const std::vector<Fits>& left_out, const Positions& positions,
                const std::string& phase, double samples, ObservableResult& result) {
    if (positions.exposure.has_value() == positions.localisation.has_value()) return;
    const bool is_sigma = positions.exposure.has_value();
    const char* name = is_sigma ? "localisation" : "exposure";
    const char* unit = is_sigma ? "a" : "time unit";
    std::vector<double> left;
    for (const Fits& part : left_out) left.push_back(hidden(part, positions));
    Measurement m = fitted(name, unit, phase, hidden(fits, positions), left, samples, "");
    if (m.value && !(*m.value > 0)) {
        m.reason = std::string(is_sigma ? "the offset is below that of the exposure: σ² = "
                                        : "the offset is above 4 σ²: the exposure would be ") +
                   fmt::format("{:.3g}", *m.value);
        if (m.error) m.reason += fmt::format(" ± {:.2g}", *m.error);
        m.value.reset();
        m.error.reset();
        m.samples = 0;
    }
    if (m.value && is_sigma) {
        const double sigma = std::sqrt(*m.value);
        if (m.error) m.error = *m.error / (2 * sigma);
        m.value = sigma;
    }
    result.measurements.push_back(std::move(m));
}

// The fitted line of one phase, for the plot.
void add_line(const Fits& fits, const std::string& phase, Curve& line) {
    if (!std::isfinite(fits.diffusion) || !(fits.last > fits.first)) return;
    constexpr int pieces = 20;
    for (int i = 0; i <= pieces; ++i) {
        const double t = fits.first * std::pow(fits.last / fits.first, 1.0 * i / pieces);
        line.columns[0].values.push_back(t);
        line.columns[1].values.push_back(4 * fits.diffusion * t + fits.offset);
        line.text_columns["phase"].push_back(phase);
    }
}

}  // namespace

void add_msd(const MsdTable& table, ObservableResult& result) {
    Curve curve;
    curve.name = "msd";
    curve.title = "Mean squared displacement";
    Column t{"t", "time unit", "Lag time", {}};
    Column msd{"msd", "a^2", "Mean squared displacement", {}};
    Column err{"err", "a^2", "Standard error", {}};
    Column n{"n", "-", "Pairs of sightings", {}};
    std::vector<std::string> phase;
    Curve line{"msd_fit",
               "MSD = 4 D t + c",
               {{"t", "time unit", "Lag time", {}}, {"msd", "a^2", "Fitted MSD", {}}},
               {}};

    const Positions positions(table);
    const std::size_t none = std::numeric_limits<std::size_t>::max();
    for (std::size_t c = 0; c < names.size(); ++c) {
        const MsdTable::Series& series = table.series[c];
        const std::string name = names[c];
        if (c > 0 && !table.has_phases) {
            for (const auto& [what, unit] :
                 {std::pair{"d", "a^2/time unit"}, std::pair{"exponent", "-"},
                  std::pair{"offset", "a^2"}}) {
                result.measurements.push_back(
                    missing(std::string(what) + "_" + name, unit,
                            "the phases of the particles were not followed"));
            }
            continue;
        }
        const std::vector<double> mean = mean_without(series, none);
        std::vector<std::vector<double>> left(series.sum.size());
        std::vector<Fits> fits_left;
        std::vector<double> d_left, exponent_left, offset_left;
        for (std::size_t g = 0; g < left.size(); ++g) {
            left[g] = mean_without(series, g);
            // A group without particles has no information on their scatter.
            if (std::ranges::all_of(series.pairs[g], [](double p) { return !(p > 0); })) continue;
            const Fits fits = fit_last_decade(table.time, left[g], positions);
            fits_left.push_back(fits);
            d_left.push_back(fits.diffusion);
            exponent_left.push_back(fits.exponent);
            offset_left.push_back(fits.offset);
        }
        for (std::size_t l = 0; l < mean.size(); ++l) {
            if (!std::isfinite(mean[l])) continue;
            double pairs = 0;
            std::vector<double> values;
            for (std::size_t g = 0; g < left.size(); ++g) {
                pairs += series.pairs[g][l];
                if (series.pairs[g][l] > 0) values.push_back(left[g][l]);
            }
            t.values.push_back(table.time[l]);
            msd.values.push_back(mean[l]);
            err.values.push_back(student_jackknife_error(values).value_or(undefined));
            n.values.push_back(pairs);
            phase.push_back(name);
        }
        const Fits fits = fit_last_decade(table.time, mean, positions);
        result.measurements.push_back(fitted("d", "a^2/time unit", name, fits.diffusion, d_left,
                                             table.particles[c], table.note));
        result.measurements.push_back(fitted("exponent", "-", name, fits.exponent, exponent_left,
                                             table.particles[c], table.note));
        if (positions.exposure && positions.localisation && std::isfinite(fits.offset)) {
            result.measurements.push_back(
                {"offset_" + name, "a^2", fits.offset, std::nullopt, 0,
                 "held: it follows from the given localisation error and exposure"});
        } else {
            result.measurements.push_back(fitted("offset", "a^2", name, fits.offset, offset_left,
                                                 table.particles[c], table.note));
        }
        add_hidden(fits, fits_left, positions, name, table.particles[c], result);
        add_line(fits, name, line);
    }
    if (t.values.empty()) {
        result.measurements.clear();
        result.reason = "no particle is seen in two frames";
        return;
    }
    curve.columns = {t, msd, err, n};
    curve.text_columns["phase"] = phase;
    result.curves.push_back(curve);
    if (!line.columns[0].values.empty()) result.curves.push_back(line);
}

}  // namespace grainfield::analysis
