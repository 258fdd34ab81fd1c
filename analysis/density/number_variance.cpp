#include "analysis/density/number_variance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/recorded_options.h"
#include "core/errors.h"
#include "core/support/parallel.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double rounding = 1e-12;  // of sums that cancel, relative

// What stored sums may be, so that 64 and 128 bits hold a hundred such parts.
constexpr double kMostFrames = 0x1p32;
constexpr double kMostProduct = 0x1p120;

void require_possible(double number, double most) {
    if (number >= 0 && number <= most) return;
    throw InputError(ErrorText{"stored sums of the number variance do not fit",
                               fmt::format("{:g}", number), fmt::format("0 … {:g}", most),
                               "measure the part again"});
}

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
    table.choice("reading", options.reading,
                 {{"temporal", VarianceReading::temporal},
                  {"pooled", VarianceReading::pooled},
                  {"spatial-mean", VarianceReading::spatial_mean}},
                 "variance over frames at each position, over both, or of the mean over positions");
    table.number("border", options.border, "a", {0, 1e6},
                 "strip left free along walls; auto: 10, at most a tenth of the box");
    return table;
}

NumberVariance::NumberVariance(const NumberVarianceOptions& options, const Box& box,
                               std::int64_t frames, int threads, std::int64_t first)
    : options_(options),
      box_(box),
      grid_(box, options.step, border_of(options, box)),
      plan_(BlockPlan::of(frames)),
      threads_(threads),
      first_(first) {
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
    block.squared_sums.assign(sizes_.size(), 0);
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
    sample.cells = here.cells_of(pattern.position);
    std::vector<std::int32_t> contents(grid_.size(), 0);
    for (const std::int32_t at : sample.cells) ++contents[static_cast<std::size_t>(at)];
    const WindowCounter counter(grid_, contents, sizes_.back());
    sample.sums.reserve(sizes_.size());
    for (int m : sizes_) sample.sums.push_back(counter.sums(m));
    return sample;
}

void NumberVariance::add(Sample sample) {
    Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(first_ + added_++))];
    ++block.frames;
    block.particles += sample.particles;
    density_.add(sample.particles / box_.area());
    for (const std::int32_t at : sample.cells) ++block.contents[static_cast<std::size_t>(at)];
    for (std::size_t s = 0; s < sample.sums.size(); ++s) {
        block.sums[s].sum += sample.sums[s].sum;
        block.sums[s].squares += sample.sums[s].squares;
        block.squared_sums[s] += sample.sums[s].sum * sample.sums[s].sum;
    }
}

void NumberVariance::merge(const NumberVariance& later) {
    if (later.sizes_ != sizes_ || later.grid_.cells != grid_.cells) {
        throw InputError(ErrorText{"the parts to merge have different boxes or windows", "", "",
                                   "analyse them one by one"});
    }
    const std::int64_t end = first_ + added_;
    added_ += later.added_;
    density_.append(later.density_);
    if (are_cut_alike(plan_, end, later.plan_, later.first_)) {
        for (std::size_t b = 0; b < blocks_.size(); ++b) add_block(blocks_[b], later.blocks_[b]);
        return;
    }
    plan_.frames = std::max(plan_.frames, added_);
    blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
    blocks_ = joined_blocks(std::move(blocks_), add_block);
    if (blocks_.empty()) blocks_.push_back(empty_block());
    plan_.blocks = static_cast<int>(blocks_.size());
}

void NumberVariance::save(Checkpoint& checkpoint, const std::string& prefix) const {
    checkpoint.reals[prefix + "density"] = density_.value;
    std::vector<double>& reals = checkpoint.reals[prefix + "particles"];
    std::vector<std::int64_t>& counts = checkpoint.integers[prefix + "counts"];
    counts = {added_};
    const auto add_wide = [&](Wide number) {
        counts.push_back(static_cast<std::int64_t>(number >> 62));
        counts.push_back(static_cast<std::int64_t>(number & ((Wide{1} << 62) - 1)));
    };
    for (const Block& block : blocks_) {
        reals.push_back(block.particles);
        counts.push_back(block.frames);
        counts.insert(counts.end(), block.contents.begin(), block.contents.end());
        for (std::size_t s = 0; s < block.sums.size(); ++s) {
            add_wide(block.sums[s].sum);
            add_wide(block.sums[s].squares);
            add_wide(block.squared_sums[s]);
        }
    }
}

void NumberVariance::restore(const Checkpoint& checkpoint, const std::string& prefix) {
    const auto reals = checkpoint.reals.find(prefix + "particles");
    const auto density = checkpoint.reals.find(prefix + "density");
    const auto counts = checkpoint.integers.find(prefix + "counts");
    const std::size_t in_block = 1 + blocks_.front().contents.size() + 6 * sizes_.size();
    if (reals == checkpoint.reals.end() || density == checkpoint.reals.end() ||
        counts == checkpoint.integers.end() || reals->second.size() != blocks_.size() ||
        counts->second.size() != 1 + in_block * blocks_.size()) {
        throw InputError(ErrorText{"stored sums of the number variance do not fit",
                                   "another number of cells, windows or blocks", "",
                                   "measure the part again"});
    }
    density_.value = density->second;
    const std::int64_t* next = counts->second.data();
    const auto stored = [&](double most) {
        const std::int64_t number = *next++;
        require_possible(static_cast<double>(number), most);
        return number;
    };
    const auto wide = [&](double most) {
        const Wide high = *next++;
        const Wide low = *next++;
        const Wide number = (high << 62) + low;
        require_possible(static_cast<double>(number), most);
        return number;
    };
    // The sums over all blocks, and their products in `values`, stay exact.
    const auto blocks = static_cast<double>(blocks_.size());
    added_ = stored(kMostFrames);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        Block& block = blocks_[b];
        block.particles = reals->second[b];
        block.frames = stored(kMostFrames / blocks);
        for (std::int32_t& content : block.contents) {
            content = static_cast<std::int32_t>(stored(0x1p31 / blocks - 1));
        }
        for (std::size_t s = 0; s < block.sums.size(); ++s) {
            const auto positions = static_cast<double>(grid_.positions(sizes_[s]));
            block.sums[s].sum = wide(std::sqrt(kMostProduct) / blocks);
            block.sums[s].squares = wide(kMostProduct / (kMostFrames * positions * blocks));
            block.squared_sums[s] = wide(kMostProduct / (kMostFrames * blocks));
        }
    }
}

void NumberVariance::add_block(Block& to, const Block& from) {
    to.frames += from.frames;
    to.particles += from.particles;
    for (std::size_t c = 0; c < to.contents.size(); ++c) to.contents[c] += from.contents[c];
    for (std::size_t s = 0; s < to.sums.size(); ++s) {
        to.sums[s].sum += from.sums[s].sum;
        to.sums[s].squares += from.sums[s].squares;
        to.squared_sums[s] += from.squared_sums[s];
    }
}

// A run that was cut short leaves the last ones empty.
std::vector<std::size_t> NumberVariance::filled_blocks() const {
    std::vector<std::size_t> filled;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (blocks_[b].frames > 0) filled.push_back(b);
    }
    return filled;
}

NumberVariance::Block NumberVariance::total(std::optional<std::size_t> without) const {
    Block sums = empty_block();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (!without || *without != b) add_block(sums, blocks_[b]);
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
        // frames · Σ m² − (Σ m)² is exact; m the sum over positions of a frame.
        const Wide of_means = frames * block.squared_sums[s] - sum * sum;
        values.spatial_mean.push_back(frames > 1 ? static_cast<double>(of_means) /
                                                       (all * static_cast<double>(positions) *
                                                        static_cast<double>(frames - 1))
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
    std::vector<Values> left;
    if (added_ >= 2) {
        const std::vector<std::size_t> filled = filled_blocks();
        left.resize(filled.size());
        parallel_for(static_cast<std::int64_t>(filled.size()), threads_, [&](std::int64_t i) {
            const auto at = static_cast<std::size_t>(i);
            left[at] = values(total(filled[at]));
        });
    }
    const bool several = added_ >= 2;
    const VarianceReading reading = several ? options_.reading : VarianceReading::pooled;
    const std::string reason =
        several ? "" : "one frame: variance over positions, static structure is in it";
    const char* title = !several
                            ? "Number variance over positions: one frame, static structure included"
                        : reading == VarianceReading::temporal ? "Number variance, temporal"
                        : reading == VarianceReading::pooled   ? "Number variance, pooled"
                                                               : "Variance of the spatial mean";
    const std::vector<BlockDrift> of_positions = drifts_of_positions();
    const std::vector<BlockDrift> of_spatial_mean = drifts_of_spatial_mean();
    const auto drifts_of = [&](VarianceReading of) -> const std::vector<BlockDrift>& {
        return of == VarianceReading::spatial_mean ? of_spatial_mean : of_positions;
    };
    const Estimate wanted = estimate(best, left, drifts_of(reading), reading);
    const auto add_curve = [&](const char* name, const char* of_title, VarianceReading of) {
        const Estimate found = estimate(best, left, drifts_of(of), of);
        result.curves.push_back(curve(name, of_title, found.variance, found.error, best.mean));
    };
    result.curves.push_back(curve("variance", title, wanted.variance, wanted.error, best.mean));
    add_curve("variance_pooled", "Number variance, pooled", VarianceReading::pooled);
    if (several && reading != VarianceReading::temporal) {
        add_curve("variance_temporal", "Number variance, temporal", VarianceReading::temporal);
    }
    if (several && reading != VarianceReading::spatial_mean) {
        add_curve("variance_spatial_mean", "Variance of the spatial mean",
                  VarianceReading::spatial_mean);
    }
    add_slopes(result, best, left, wanted, reading);
    add_key_numbers(result, best, wanted, reading, reason);
    return result;
}

std::vector<double> NumberVariance::frames_of(const std::vector<std::size_t>& blocks) const {
    std::vector<double> frames;
    for (const std::size_t b : blocks) frames.push_back(static_cast<double>(blocks_[b].frames));
    return frames;
}

// The BlockScatter of the content of a window, averaged over its positions p. With the content C_b
// of a block of f_b frames Σ_b f_b (C_b/f_b − ΣC/F)² = Σ_b C_b²/f_b − (ΣC)²/F, and C_b C_c follows
// from the square of C_b + C_c.
std::vector<BlockDrift> NumberVariance::drifts_of_positions() const {
    const std::vector<std::size_t> filled = filled_blocks();
    const std::size_t blocks = filled.size();
    std::vector<BlockDrift> drifts(sizes_.size());
    if (blocks < 2) return drifts;
    // Of each block, of each with the next, and of all.
    std::vector<std::vector<double>> squares(2 * blocks);
    parallel_for(static_cast<std::int64_t>(squares.size()), threads_, [&](std::int64_t i) {
        const auto at = static_cast<std::size_t>(i);
        const std::size_t first = at < blocks ? at : at + 1 == squares.size() ? 0 : at - blocks;
        const std::size_t last = at < blocks                ? at
                                 : at + 1 == squares.size() ? blocks - 1
                                                            : first + 1;
        std::vector<std::int32_t> contents = blocks_[filled[first]].contents;
        for (std::size_t b = first + 1; b <= last; ++b) {
            const std::vector<std::int32_t>& more = blocks_[filled[b]].contents;
            for (std::size_t c = 0; c < contents.size(); ++c) contents[c] += more[c];
        }
        const WindowCounter counter(grid_, contents, sizes_.back());
        for (const int m : sizes_) {
            squares[at].push_back(static_cast<double>(counter.sums(m).squares));
        }
    });
    const std::vector<double> frames = frames_of(filled);
    double all = 0;
    for (const double f : frames) all += f;
    for (std::size_t s = 0; s < sizes_.size(); ++s) {
        const double of_all = squares.back()[s] / all;
        BlockScatter scatter{.squares = -of_all};
        for (std::size_t b = 0; b < blocks; ++b) {
            const double f = frames[b];
            scatter.squares += squares[b][s] / f;
            if (b + 1 == blocks) break;
            const double g = frames[b + 1];
            const double product =
                0.5 * (squares[blocks + b][s] - squares[b][s] - squares[b + 1][s]);
            scatter.steps +=
                2 * f * g / (f + g) *
                (squares[b][s] / (f * f) + squares[b + 1][s] / (g * g) - 2 * product / (f * g));
        }
        if (scatter.squares < rounding * of_all) continue;  // the same in every block
        const double weight =
            static_cast<double>(blocks) / (all * static_cast<double>(grid_.positions(sizes_[s])));
        drifts[s] = block_drift({weight * scatter.squares, weight * scatter.steps}, blocks);
    }
    return drifts;
}

std::vector<BlockDrift> NumberVariance::drifts_of_spatial_mean() const {
    const std::vector<std::size_t> filled = filled_blocks();
    const std::vector<double> frames = frames_of(filled);
    std::vector<BlockDrift> drifts;
    for (std::size_t s = 0; s < sizes_.size(); ++s) {
        std::vector<double> means;
        for (const std::size_t b : filled) {
            const Block& block = blocks_[b];
            means.push_back(static_cast<double>(block.sums[s].sum) /
                            static_cast<double>(block.frames * grid_.positions(sizes_[s])));
        }
        BlockScatter scatter;
        add_scatter<double>(scatter, frames, means);
        drifts.push_back(block_drift(scatter, filled.size()));
    }
    return drifts;
}

NumberVariance::Estimate NumberVariance::estimate(const Values& best,
                                                  const std::vector<Values>& left,
                                                  const std::vector<BlockDrift>& drifts,
                                                  VarianceReading reading) const {
    Estimate found{best.of(reading), std::vector<double>(sizes_.size(), undefined),
                   std::vector<std::string>(sizes_.size())};
    for (std::size_t s = 0; s < sizes_.size(); ++s) {
        if (left.empty()) {
            found.error[s] = single_frame_error(found.variance[s], lengths_[s]);
            continue;
        }
        std::vector<double> values;
        for (const Values& part : left) values.push_back(part.of(reading)[s]);
        const SeriesError of_blocks = left_out_error(values);
        found.reason[s] = values.size() < 4 ? too_few_blocks : of_blocks.reason;
        found.error[s] = of_blocks.error.value_or(undefined);
        if (drifts[s].step_ratio < least_step_ratio) {
            found.error[s] = undefined;
            found.reason[s] = slower_than_the_run;
        }
        if (reading == VarianceReading::pooled) continue;
        const double independent = found.variance[s] / static_cast<double>(added_);
        const double added = std::max(0.0, drifts[s].variance_of_mean - independent);
        found.variance[s] += added;
        found.error[s] = std::hypot(found.error[s], added);
    }
    return found;
}

const std::vector<double>& NumberVariance::Values::of(VarianceReading reading) const {
    switch (reading) {
        case VarianceReading::pooled:
            return pooled;
        case VarianceReading::spatial_mean:
            return spatial_mean;
        case VarianceReading::temporal:
            break;
    }
    return temporal;
}

// Whether the line at size `at` goes through size s, too.
bool NumberVariance::is_in_slope(std::size_t s, std::size_t at) const {
    constexpr double reach = 1.3;
    const double ratio = lengths_[s] / lengths_[at];
    return (s + 1 >= at && s <= at + 1) || (ratio <= reach && ratio >= 1 / reach);
}

// The slope of a line through ln σ² against ln ℓ around each size; NaN where there is none.
std::vector<double> NumberVariance::slopes(const std::vector<double>& variance) const {
    std::vector<double> slopes(variance.size(), undefined);
    for (std::size_t i = 1; i + 1 < variance.size(); ++i) {
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
        for (std::size_t j = 0; j < variance.size(); ++j) {
            if (!is_in_slope(j, i)) continue;
            if (!(variance[j] > 0)) {
                n = 0;
                break;
            }
            const double x = std::log(lengths_[j] / lengths_[i]);
            const double y = std::log(variance[j]);
            n += 1;
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
        }
        if (n >= 3) slopes[i] = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    }
    return slopes;
}

void NumberVariance::add_slopes(ObservableResult& result, const Values& best,
                                const std::vector<Values>& left, const Estimate& wanted,
                                VarianceReading reading) const {
    const std::vector<double> beta = slopes(wanted.variance);
    const std::vector<double> of_independent = slopes(best.of(reading));
    const auto has_errors = [&](std::size_t at) {
        for (std::size_t s = 0; s < sizes_.size(); ++s) {
            if (is_in_slope(s, at) && !std::isfinite(wanted.error[s])) return false;
        }
        return true;
    };
    std::vector<std::vector<double>> parts;
    for (const Values& part : left) parts.push_back(slopes(part.of(reading)));
    // Beyond half a periodic box the slope is that of the fixed number of particles.
    const double most = box_.is_periodic()
                            ? 0.5 * std::min(box_.length.x, box_.length.y) * (1 + 1e-9)
                            : std::numeric_limits<double>::infinity();
    Curve curve{"variance_slope",
                "Local exponent of the number variance",
                {{"l", "a", "Window side", {}},
                 {"beta", "-", "d ln variance/d ln l", {}},
                 {"err", "-", "Standard error", {}}},
                {}};
    for (std::size_t s = 0; s < beta.size(); ++s) {
        if (!std::isfinite(beta[s]) || lengths_[s] > most) continue;
        std::vector<double> values;
        for (const std::vector<double>& part : parts) values.push_back(part[s]);
        curve.columns[0].values.push_back(lengths_[s]);
        curve.columns[1].values.push_back(beta[s]);
        const double error = left_out_error(values).error.value_or(undefined);
        curve.columns[2].values.push_back(
            has_errors(s) ? std::hypot(error, beta[s] - of_independent[s]) : undefined);
    }
    if (!curve.columns[0].values.empty()) result.curves.push_back(std::move(curve));
}

void NumberVariance::add_key_numbers(ObservableResult& result, const Values& best,
                                     const Estimate& wanted, VarianceReading reading,
                                     const std::string& reason) const {
    Measurement density = density_.measurement("number_density", "1/a^2", std::nullopt,
                                               "one frame: no error from fluctuations");
    result.measurements.push_back(density);
    // Readings are different quantities: a pooled one holds the static structure, too.
    const char* name = reading == VarianceReading::temporal ? "relative_variance_10a"
                       : reading == VarianceReading::pooled ? "relative_variance_10a_pooled"
                                                            : "relative_variance_10a_spatial_mean";
    const auto at = std::lower_bound(lengths_.begin(), lengths_.end(), 10 * (1 - 1e-9));
    if (at == lengths_.end()) {
        result.measurements.push_back(missing(name, "-", "no window of 10 a among the sizes"));
        return;
    }
    const auto s = static_cast<std::size_t>(at - lengths_.begin());
    Measurement relative{name, "-", std::nullopt, std::nullopt, 0, reason};
    if (best.mean[s] > 0) {
        relative.value = wanted.variance[s] / best.mean[s];
        const double error = wanted.error[s] / best.mean[s];
        if (std::isfinite(error) && error > 0) {
            relative.error = error;
            // As many independent normal numbers have a variance with this relative error.
            relative.samples = 1 + 2 * std::pow(*relative.value / error, 2);
        } else if (reason.empty()) {
            relative.reason = wanted.reason[s];
        }
    } else {
        relative.reason = "no particle inside the border";
    }
    result.measurements.push_back(relative);
}

}  // namespace grainfield::analysis
