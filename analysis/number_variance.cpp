#include "analysis/number_variance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/bond_statistics.h"
#include "core/errors.h"
#include "core/parallel.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

double border_of(const NumberVarianceOptions& options, const Box& box) {
    if (options.border) return *options.border;
    return std::min(10.0, 0.1 * std::min(box.length.x, box.length.y));
}

bool same_length(double a, double b) {
    return std::abs(a - b) <= 1e-9 * std::max(a, b);
}

}  // namespace

OptionTable describe(NumberVarianceOptions& options) {
    OptionTable table("variance");
    table.number("smallest", options.smallest, "a", {1e-3, 1e6}, "smallest window");
    table.number("largest", options.largest, "a", {1e-3, 1e6}, "largest window");
    table.number("increment", options.increment, "a", {1e-3, 1e6}, "from window to window");
    table.number("step", options.step, "a", {1e-3, 1e6}, "displacement of the windows");
    table.number("border", options.border, "a", {0, 1e6},
                 "strip left free along walls; auto: 10, at most a tenth of the box");
    return table;
}

NumberVariance::NumberVariance(const NumberVarianceOptions& options, const Box& box,
                               std::int64_t frames, int threads)
    : options_(options),
      box_(box),
      grid_(box, options.step, border_of(options, box)),
      plan_(BlockPlan::of(frames)),
      threads_(threads) {
    const double cell = std::sqrt(grid_.cell.x * grid_.cell.y);
    const auto steps = static_cast<std::int64_t>(
        std::floor((options.largest - options.smallest) / options.increment * (1 + 1e-12)));
    for (std::int64_t i = 0; i <= steps; ++i) {
        const double wanted = options.smallest + static_cast<double>(i) * options.increment;
        const double cells = std::round(wanted / cell);
        if (cells < 1 || cells > 1 << 20 || !grid_.fits(static_cast<int>(cells))) continue;
        const int m = static_cast<int>(cells);
        if (!sizes_.empty() && sizes_.back() == m) continue;
        sizes_.push_back(m);
        lengths_.push_back(m * cell);
    }
    blocks_.assign(static_cast<std::size_t>(plan_.blocks), empty_block());
}

NumberVariance::Block NumberVariance::empty_block() const {
    Block block;
    block.contents.assign(sizes_.empty() ? 0 : grid_.size(), 0);
    block.sums.assign(sizes_.size(), {});
    return block;
}

NumberVariance::Sample NumberVariance::measure(const Pattern& pattern) const {
    if (!same_length(pattern.box.length.x, box_.length.x) ||
        !same_length(pattern.box.length.y, box_.length.y)) {
        throw InputError(
            ErrorText{fmt::format("the box changes at frame {}", pattern.frame),
                      fmt::format("{} x {} a", pattern.box.length.x, pattern.box.length.y),
                      fmt::format("{} x {} a as before", box_.length.x, box_.length.y),
                      "analyse the parts with a constant box one by one"});
    }
    Sample sample;
    sample.frame = pattern.frame;
    sample.particles = static_cast<double>(pattern.size());
    if (sizes_.empty()) return sample;
    CountGrid here = grid_;
    here.origin += pattern.box.origin - box_.origin;
    sample.contents = here.count(pattern.position);
    const WindowCounter counter(grid_, sample.contents, sizes_.back());
    sample.sums.reserve(sizes_.size());
    for (int m : sizes_) sample.sums.push_back(counter.sums(m));
    return sample;
}

void NumberVariance::add(Sample sample) {
    Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(added_++))];
    ++block.frames;
    block.particles += sample.particles;
    density_.add(sample.particles / box_.area());
    for (std::size_t c = 0; c < sample.contents.size(); ++c) {
        block.contents[c] += sample.contents[c];
    }
    for (std::size_t s = 0; s < sample.sums.size(); ++s) {
        block.sums[s].sum += sample.sums[s].sum;
        block.sums[s].squares += sample.sums[s].squares;
    }
}

void NumberVariance::merge(const NumberVariance& later) {
    if (later.sizes_ != sizes_ || later.grid_.cells != grid_.cells) {
        throw InputError(ErrorText{"the parts to merge have different boxes or windows", "", "",
                                   "analyse them one by one"});
    }
    added_ += later.added_;
    density_.append(later.density_);
    plan_.frames = std::max(plan_.frames, added_);
    blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
    std::erase_if(blocks_, [](const Block& block) { return block.frames <= 0; });
    if (blocks_.empty()) blocks_.push_back(empty_block());
    plan_.blocks = static_cast<int>(blocks_.size());
}

NumberVariance::Block NumberVariance::total(std::optional<std::size_t> without) const {
    Block sums = empty_block();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (without && *without == b) continue;
        const Block& block = blocks_[b];
        sums.frames += block.frames;
        sums.particles += block.particles;
        for (std::size_t c = 0; c < sums.contents.size(); ++c) {
            sums.contents[c] += block.contents[c];
        }
        for (std::size_t s = 0; s < sums.sums.size(); ++s) {
            sums.sums[s].sum += block.sums[s].sum;
            sums.sums[s].squares += block.sums[s].squares;
        }
    }
    return sums;
}

NumberVariance::Values NumberVariance::values(const Block& block) const {
    Values values;
    const WindowCounter of_sum(grid_, block.contents, sizes_.back());
    const Wide frames = block.frames;
    for (std::size_t s = 0; s < sizes_.size(); ++s) {
        const Wide positions = grid_.positions(sizes_[s]);
        const Wide sum = block.sums[s].sum;
        const Wide squares = block.sums[s].squares;
        const auto all = static_cast<double>(frames * positions);
        values.mean.push_back(frames > 0 ? static_cast<double>(sum) / all : undefined);
        values.pooled.push_back(
            frames > 0 ? static_cast<double>(frames * positions * squares - sum * sum) / (all * all)
                       : undefined);
        const Wide spread = frames * squares - of_sum.sums(sizes_[s]).squares;
        values.temporal.push_back(frames > 1 ? static_cast<double>(spread) /
                                                   (all * static_cast<double>(frames - 1))
                                             : undefined);
    }
    return values;
}

double NumberVariance::single_frame_error(double variance, double length) const {
    const double independent =
        grid_.cells[0] * grid_.cell.x / length * (grid_.cells[1] * grid_.cell.y / length);
    return independent > 2 ? variance * std::sqrt(2 / (independent - 1)) : undefined;
}

Curve NumberVariance::curve(const char* name, const char* title,
                            const std::vector<double>& variance, const std::vector<double>& error,
                            const std::vector<double>& mean) const {
    Curve curve;
    curve.name = name;
    curve.title = title;
    curve.columns = {Column{"l", "a", "Window side", lengths_},
                     Column{"variance", "-", "Number variance", variance},
                     Column{"err", "-", "Standard error", error},
                     Column{"mean", "-", "Mean number", mean}};
    return curve;
}

ObservableResult NumberVariance::result() const {
    ObservableResult result;
    result.name = "variance";
    NumberVarianceOptions options = options_;
    result.options = recorded(describe(options));
    if (added_ == 0) {
        result.reason = "no frames";
        return result;
    }
    if (sizes_.empty()) {
        result.reason = fmt::format(
            "no window fits: {:.3g} x {:.3g} a are left inside the border, the smallest window is "
            "{:.3g} a",
            grid_.cells[0] * grid_.cell.x, grid_.cells[1] * grid_.cell.y, options_.smallest);
        return result;
    }
    const Block sums = total(std::nullopt);
    if (sums.particles <= 0) {
        result.reason = "no particles";
        return result;
    }
    const Values best = values(sums);
    std::vector<double> temporal_error(sizes_.size(), undefined);
    std::vector<double> pooled_error(sizes_.size(), undefined);
    if (added_ >= 2) {
        std::vector<Values> left(blocks_.size());
        parallel_for(static_cast<std::int64_t>(blocks_.size()), threads_, [&](std::int64_t b) {
            left[static_cast<std::size_t>(b)] = values(total(static_cast<std::size_t>(b)));
        });
        for (std::size_t s = 0; s < sizes_.size(); ++s) {
            std::vector<double> temporal, pooled;
            for (const Values& values : left) {
                temporal.push_back(values.temporal[s]);
                pooled.push_back(values.pooled[s]);
            }
            temporal_error[s] = jackknife_error(temporal).value_or(undefined);
            pooled_error[s] = jackknife_error(pooled).value_or(undefined);
        }
    } else {
        for (std::size_t s = 0; s < sizes_.size(); ++s) {
            pooled_error[s] = single_frame_error(best.pooled[s], lengths_[s]);
        }
    }
    const bool temporal = added_ >= 2;
    const std::string reason =
        temporal ? "" : "one frame: variance over positions, static structure is in it";
    result.curves = {
        curve("variance",
              temporal ? "Number variance, temporal"
                       : "Number variance over positions: one frame, static structure included",
              temporal ? best.temporal : best.pooled, temporal ? temporal_error : pooled_error,
              best.mean),
        curve("variance_pooled", "Number variance, pooled", best.pooled, pooled_error, best.mean)};

    Measurement density = density_.measurement("number_density", "1/a^2", std::nullopt,
                                               "one frame: no error from fluctuations");
    result.measurements.push_back(density);
    const auto at = std::lower_bound(lengths_.begin(), lengths_.end(), 10 * (1 - 1e-9));
    if (at == lengths_.end()) {
        result.measurements.push_back(
            missing("relative_variance_10a", "-", "no window of 10 a among the sizes"));
        return result;
    }
    const auto s = static_cast<std::size_t>(at - lengths_.begin());
    const Curve& curve = result.curves.front();
    Measurement relative{"relative_variance_10a", "-", std::nullopt, std::nullopt, 0, reason};
    if (best.mean[s] > 0) {
        relative.value = curve.columns[1].values[s] / best.mean[s];
        const double error = curve.columns[2].values[s] / best.mean[s];
        if (std::isfinite(error) && error > 0) {
            relative.error = error;
            // As many independent normal numbers have a variance with this relative error.
            relative.samples = 1 + 2 * std::pow(*relative.value / error, 2);
        } else if (reason.empty()) {
            relative.reason = error == 0 ? "the same in every frame: no error from fluctuations"
                                         : "too few frames for an error";
        }
    } else {
        relative.reason = "no particle inside the border";
    }
    result.measurements.push_back(relative);
    return result;
}

}  // namespace grainfield::analysis
