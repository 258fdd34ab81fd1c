#include "analysis/blocks.h"

#include <algorithm>
#include <cmath>

namespace grainfield::analysis {

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

void MeanSeries::append(const MeanSeries& later) {
    value.insert(value.end(), later.value.begin(), later.value.end());
}

Measurement MeanSeries::measurement(std::string name, std::string unit,
                                    std::optional<double> single_error,
                                    const std::string& single_reason, double single_samples) const {
    if (value.empty()) return missing(std::move(name), std::move(unit), single_reason);
    const auto frames = static_cast<std::int64_t>(value.size());
    const BlockPlan plan = BlockPlan::of(frames);
    std::vector<double> block_sum(static_cast<std::size_t>(plan.blocks), 0.0);
    std::vector<double> block_count(static_cast<std::size_t>(plan.blocks), 0.0);
    double sum = 0;
    for (std::int64_t i = 0; i < frames; ++i) {
        const auto b = static_cast<std::size_t>(plan.block_of(i));
        const double x = value[static_cast<std::size_t>(i)];
        block_sum[b] += x;
        block_count[b] += 1;
        sum += x;
    }
    Measurement m{
        std::move(name), std::move(unit), sum / static_cast<double>(frames), std::nullopt, 0, ""};
    if (frames == 1) {
        m.error = single_error;
        m.samples = single_samples;
        m.reason = single_reason;
        return m;
    }
    std::vector<double> left(block_sum.size());
    for (std::size_t b = 0; b < left.size(); ++b) {
        left[b] = (sum - block_sum[b]) / (static_cast<double>(frames) - block_count[b]);
    }
    m.error = jackknife_error(left, 2);
    double squares = 0;
    for (double x : value) squares += (x - *m.value) * (x - *m.value);
    const double variance = squares / static_cast<double>(frames - 1);
    constexpr double rounding = 1e-13;
    if (!(m.error.value_or(0) > rounding * std::abs(*m.value))) {
        m.error.reset();
        m.samples = 1;
        m.reason = "the same in every frame: no error from fluctuations";
        return m;
    }
    m.samples = std::clamp(variance / (*m.error * *m.error), 1.0, static_cast<double>(frames));
    return m;
}

Measurement missing(std::string name, std::string unit, std::string reason) {
    return {std::move(name), std::move(unit), std::nullopt, std::nullopt, 0, std::move(reason)};
}

}  // namespace grainfield::analysis
