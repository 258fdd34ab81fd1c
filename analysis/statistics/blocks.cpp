#include "analysis/statistics/blocks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace grainfield::analysis {
namespace {

constexpr std::size_t least_values = 4;    // for an error
constexpr std::size_t least_to_judge = 8;  // whether values are correlated

double mean_of(std::span<const double> values) {
    double sum = 0;
    for (double x : values) sum += x;
    return sum / static_cast<double>(values.size());
}

double variance_of(std::span<const double> values, double mean) {
    double squares = 0;
    for (double x : values) squares += (x - mean) * (x - mean);
    return squares / (static_cast<double>(values.size()) - 1);
}

bool all_the_same(std::span<const double> values, double mean, double scale) {
    constexpr double rounding = 1e-13;
    const double limit = rounding * std::max(std::abs(mean), scale);
    return std::ranges::all_of(values, [&](double x) { return std::abs(x - mean) <= limit; });
}

std::vector<double> block_means(std::span<const double> values) {
    const BlockPlan plan = BlockPlan::of(static_cast<std::int64_t>(values.size()));
    std::vector<double> sum(static_cast<std::size_t>(plan.blocks), 0.0);
    std::vector<double> count(sum.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto b = static_cast<std::size_t>(plan.block_of(static_cast<std::int64_t>(i)));
        sum[b] += values[i];
        count[b] += 1;
    }
    for (std::size_t b = 0; b < sum.size(); ++b) sum[b] /= count[b];
    return sum;
}

// Half the mean square step over the variance: one for independent values, less for a drift.
double neumann_ratio(std::span<const double> values) {
    double steps = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
        steps += (values[i] - values[i - 1]) * (values[i] - values[i - 1]);
    }
    const auto count = static_cast<double>(values.size());
    return 0.5 * steps / (count - 1) / variance_of(values, mean_of(values));
}

// The variance of the mean over a time x of what relaxes exponentially in a time of one.
double variance_of_average(double x) {
    return x < 1e-4 ? 1 - x / 3 : 2 * (x + std::expm1(-x)) / (x * x);
}

}  // namespace

BlockPlan BlockPlan::of(std::int64_t frames, int most) {
    BlockPlan plan;
    plan.frames = std::max<std::int64_t>(frames, 1);
    plan.blocks = static_cast<int>(std::min<std::int64_t>(plan.frames, most));
    return plan;
}

int BlockPlan::block_of(std::int64_t ordinal) const {
    const std::int64_t inside = std::clamp<std::int64_t>(ordinal, 0, frames - 1);
    return static_cast<int>(inside * blocks / frames);
}

std::int64_t BlockPlan::first_of(int block) const {
    return (block * frames + blocks - 1) / blocks;
}

BlockPlan BlockPlan::lengthened(std::int64_t longer) const {
    if (longer <= frames) return *this;
    if (blocks == frames) return of(longer);  // of one frame each: they fit into any plan
    BlockPlan plan = *this;
    plan.frames *= (longer + frames - 1) / frames;
    return plan;
}

std::optional<double> jackknife_error(std::span<const double> leave_one_out, std::size_t least) {
    double sum = 0;
    std::size_t count = 0;
    for (double x : leave_one_out) {
        if (!std::isfinite(x)) continue;
        sum += x;
        ++count;
    }
    if (count < least || count < 2) return std::nullopt;
    const auto k = static_cast<double>(count);
    const double mean = sum / k;
    double squares = 0;
    for (double x : leave_one_out) {
        if (std::isfinite(x)) squares += (x - mean) * (x - mean);
    }
    return std::sqrt(squares * (k - 1) / k);
}

double student_widening(double n) {
    return std::sqrt((n - 1) / (n - 3));
}

std::optional<double> student_jackknife_error(std::span<const double> leave_one_out,
                                              std::size_t least) {
    const auto spread = jackknife_error(leave_one_out, std::max(least, least_values));
    if (!spread) return std::nullopt;
    const auto finite =
        std::ranges::count_if(leave_one_out, [](double x) { return std::isfinite(x); });
    return *spread * student_widening(static_cast<double>(finite));
}

double correlation_of_excess(double excess, double block) {
    const auto of = [block](double r) {
        return (1 + r) / (1 - r) - 2 * r * (1 - std::pow(r, block)) / (block * (1 - r) * (1 - r));
    };
    if (!(excess > 1) || !(block > 1)) return 0;
    double low = 0;
    double high = 0.9999;
    if (of(high) < excess) return high;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (of(middle) < excess ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

BlockDrift block_drift(const BlockScatter& scatter, std::size_t blocks) {
    constexpr std::size_t least_blocks = 8;
    constexpr std::size_t least_to_correct = 12;
    if (blocks < least_blocks || !(scatter.squares > 0)) return {};
    const auto k = static_cast<double>(blocks);
    BlockDrift drift;
    drift.step_ratio = 0.5 * scatter.steps / scatter.squares;
    if (blocks >= least_to_correct && drift.step_ratio < 1) {
        const auto g_of = [k](double x) {
            return variance_of_average(k * x) / variance_of_average(x);
        };
        const auto ratio_of = [&](double x) {
            const double decay = std::expm1(-x);
            const double next = decay * decay / (x * x * variance_of_average(x));
            return (1 - next) * (k - 1) / (k * (1 - g_of(x)));
        };
        const double wanted = std::max(drift.step_ratio, least_step_ratio);
        double low = 0.1;  // the ratio is below a half there, from eight blocks on
        double high = 1e4;
        for (int step = 0; step < 60; ++step) {
            const double middle = std::sqrt(low * high);
            (ratio_of(middle) < wanted ? low : high) = middle;
        }
        drift.excess = (k - 1) * g_of(low) / (1 - g_of(low));
    }
    drift.variance_of_mean = drift.excess * scatter.squares / (k * (k - 1));
    return drift;
}

double frames_of_mean(double independent, const BlockDrift& drift) {
    return 1 + independent / drift.excess;
}

SeriesError series_error(std::span<const double> series, double scale) {
    const auto count = static_cast<double>(series.size());
    const double mean = mean_of(series);
    if (series.empty()) return {std::nullopt, 0, "no values", false};
    if (series.size() > 1 && all_the_same(series, mean, scale)) {
        return {std::nullopt, 1, "the same in every frame: no error from fluctuations", false};
    }
    if (series.size() < least_values) {
        return {std::nullopt, count,
                "fewer than four frames or windows: no error from fluctuations", false};
    }
    const double variance = variance_of(series, mean);
    constexpr std::size_t least_for_blocks = 64;
    const bool in_blocks = series.size() >= least_for_blocks;
    const std::vector<double> means = in_blocks ? block_means(series) : std::vector<double>();
    const std::span<const double> looked_at = in_blocks ? std::span<const double>(means) : series;
    const double ratio = neumann_ratio(looked_at);
    double kept = 1;  // independent values a value
    if (in_blocks) {
        const auto blocks = static_cast<double>(means.size());
        const double of_blocks = variance_of(means, mean_of(means));
        const double excess = count / blocks * of_blocks / variance;
        const double r = correlation_of_excess(excess, count / blocks);
        kept = r > 0 ? (1 - r) / (1 + r) : 1 / excess;
    } else if (series.size() >= least_to_judge) {
        const double plain = 1 - ratio;
        const double r = std::min(0.99, plain + (1 + 3 * plain) / count);
        if (r > 1 / std::sqrt(count)) kept = (1 - r) / (1 + r);
    }
    SeriesError found;
    found.samples = std::clamp(count * kept, 1.0, count);
    constexpr double least_samples = 3;
    constexpr double least_ratio = 1.0 / 3;
    const bool drifts = series.size() >= least_to_judge && ratio < least_ratio;
    if (drifts || count * kept < least_samples) {
        found.is_slow = true;
        found.reason = slower_than_the_run;
        return found;
    }
    const double known = in_blocks ? static_cast<double>(means.size()) : count * kept;
    found.error = std::sqrt(variance / (count * kept)) *
                  student_widening(std::max(known, static_cast<double>(least_values)));
    if (!(*found.error > 0)) return {std::nullopt, 1, "the same in every block: no error", false};
    return found;
}

SeriesError left_out_error(std::span<const double> leave_one_out) {
    std::vector<double> values;
    for (double x : leave_one_out) {
        values.push_back((1 - static_cast<double>(leave_one_out.size())) * x);
    }
    const bool finite = std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
    if (values.size() >= least_values && !finite) {
        return {std::nullopt, 0, "not every part of the run has it: no error", false};
    }
    return series_error(values);
}

SeriesError ratio_error(std::span<const double> a, std::span<const double> b) {
    double sum_a = 0;
    double sum_b = 0;
    double values = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!(b[i] > 0)) continue;
        sum_a += a[i];
        sum_b += b[i];
        values += 1;
    }
    if (!(sum_b > 0)) return {std::nullopt, 0, "no values", false};
    std::vector<double> residual;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (b[i] > 0) residual.push_back(a[i] - sum_a / sum_b * b[i]);
    }
    SeriesError found = series_error(residual, std::abs(sum_a) / values);
    if (found.error) *found.error *= values / sum_b;
    return found;
}

void MeanSeries::append(const MeanSeries& later) {
    value.insert(value.end(), later.value.begin(), later.value.end());
}

Measurement MeanSeries::measurement(std::string name, Unit unit, std::optional<double> single_error,
                                    const std::string& single_reason, double single_samples) const {
    if (value.empty()) return missing(std::move(name), std::move(unit), single_reason);
    const double mean = mean_of(value);
    Measurement m{std::move(name), std::move(unit), mean, std::nullopt, 0, ""};
    if (value.size() == 1) {
        m.error = single_error;
        m.samples = single_samples;
        m.reason = single_reason;
        return m;
    }
    const SeriesError found = series_error(value);
    m.error = found.error;
    m.samples = found.samples;
    m.reason = found.reason;
    if (value.size() < least_values && single_error && !all_the_same(value, mean, 0)) {
        m.error = single_error;
        m.samples = single_samples;
        m.reason = "fewer than four frames: error of one frame, particles as independent";
    }
    return m;
}

Measurement measured(std::string name, Unit unit, double value, std::optional<double> error,
                     double samples, std::string reason) {
    return {std::move(name), std::move(unit), value, error, samples, std::move(reason)};
}

Measurement missing(std::string name, Unit unit, std::string reason) {
    return {std::move(name), std::move(unit), std::nullopt, std::nullopt, 0, std::move(reason)};
}

}  // namespace grainfield::analysis
