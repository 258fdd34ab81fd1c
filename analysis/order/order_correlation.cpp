#include "analysis/order/order_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/geometry/neighbours.h"
#include "core/errors.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double bin_width = 0.1;
constexpr std::int64_t most_frames = 32;
constexpr std::int64_t most_starts = 16;
constexpr std::size_t most_centres = 2000;
constexpr double least_pairs = 20;       // in a bin that is shown
constexpr std::size_t least_groups = 4;  // for an error
constexpr int parts_an_axis = 4;

bool is_known(const std::complex<double>& q) {
    return std::isfinite(q.real()) && std::isfinite(q.imag());
}

// Where y falls below 1/e for the first time; ln y is taken as linear between the points around it.
double fall(const std::vector<double>& x, const std::vector<double>& y) {
    const double level = std::exp(-1.0);
    double x_before = 0;
    double y_before = 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isfinite(y[i])) continue;
        if (y[i] < level) {
            const double share = y[i] > 0 ? std::log(y_before / level) / std::log(y_before / y[i])
                                          : (y_before - level) / (y_before - y[i]);
            return x_before + (x[i] - x_before) * share;
        }
        x_before = x[i];
        y_before = y[i];
    }
    return undefined;
}

// The jackknife error of where the correlation falls, if it does whatever is left out.
std::optional<double> error_of_fall(const std::vector<double>& left) {
    const bool all = std::ranges::all_of(left, [](double x) { return std::isfinite(x); });
    return all ? jackknife_error(left, least_groups) : std::nullopt;
}

Measurement length_measured(double value, const std::vector<double>& left, std::int64_t frames) {
    const char* name = "order_length";
    if (!std::isfinite(value)) {
        return missing(name, "a", "the correlation stays above 1/e up to 10 a");
    }
    if (value < 1) {
        return missing(name, "a",
                       fmt::format("below 1/e already at {:.2g} a: neighbours are not correlated "
                                   "over a diameter",
                                   value));
    }
    const SeriesError found = left_out_error(left);
    const double samples = std::max(1.0, found.samples) * static_cast<double>(frames) /
                           static_cast<double>(std::max<std::size_t>(1, left.size()));
    return {name, "a", value, found.error, samples, found.reason};
}

// Of values with starting frames, with parts of the box and with pieces left out.
struct TimeError {
    std::optional<double> error;
    double samples = 0;  // independent pieces
};

TimeError time_error(const std::vector<double>& starts, const std::vector<double>& parts,
                     const std::vector<double>& pieces) {
    const std::optional<double> of_starts = error_of_fall(starts);
    const std::optional<double> of_parts = error_of_fall(parts);
    const std::optional<double> of_pieces = error_of_fall(pieces);
    const double v_starts = std::pow(of_starts.value_or(0), 2);
    const double v_parts = std::pow(of_parts.value_or(0), 2);
    const double v_pieces = std::pow(of_pieces.value_or(0), 2);
    const double variance = std::max({v_starts + v_parts - v_pieces, v_starts, v_parts});
    if (!of_pieces || !(variance > 0)) return {};
    // As many as the side has that says most.
    const std::size_t groups = v_parts > v_starts ? parts.size() : starts.size();
    TimeError found;
    found.error = std::sqrt(variance) * student_widening(static_cast<double>(groups));
    const auto all = static_cast<double>(pieces.size());
    found.samples = std::clamp(all * v_pieces / variance, 1.0, all);
    return found;
}

}  // namespace

OrderCorrelation::OrderCorrelation(const Box& box, std::int64_t frames, std::int64_t first)
    : frames_(std::max<std::int64_t>(1, frames)),
      first_(first),
      stride_(std::max<std::int64_t>(1, (frames_ + most_frames - 1) / most_frames)),
      reach_(std::min(10.0, 0.5 * std::min(box.length.x, box.length.y))),
      bins_(static_cast<std::size_t>(std::max(0.0, std::floor(reach_ / bin_width + 1e-9)))),
      plan_(BlockPlan::of((frames_ + stride_ - 1) / stride_)) {
    blocks_.assign(static_cast<std::size_t>(plan_.blocks),
                   {0, 0, std::vector<double>(bins_, 0.0), std::vector<double>(bins_, 0.0)});
    for (int step = 0;; ++step) {
        const auto lag = static_cast<std::int64_t>(std::lround(std::pow(10.0, step / 8.0)));
        if (lag > frames_ / 2) break;
        if (lags_.empty() || lag > lags_.back()) lags_.push_back(lag);
    }
    const std::int64_t starts = std::min(most_starts, frames_ / 2);
    for (std::int64_t s = 0; s < starts; ++s) start_at_.push_back(s * frames_ / starts);
    of_start_.assign(start_at_.size(), std::vector<LagSum>(lags_.size()));
}

OrderCorrelation::Sample OrderCorrelation::measure(const Pattern& pattern,
                                                   const BondOrderField& field,
                                                   std::int64_t ordinal) const {
    Sample sample;
    if (ordinal % stride_ != 0 || bins_ == 0) return sample;
    sample.sum.assign(bins_, 0.0);
    sample.pairs.assign(bins_, 0.0);
    for (const Order& q : field.q) {
        if (!is_known(q)) continue;
        sample.squares += std::norm(q);
        sample.particles += 1;
    }
    const CellList cells(pattern.position, pattern.box);
    const std::size_t every = (pattern.size() + most_centres - 1) / most_centres;
    const double reach = bin_width * static_cast<double>(bins_);
    NeighbourList found;
    for (const int i : cells.order()) {
        const auto at = static_cast<std::size_t>(i);
        if (at % std::max<std::size_t>(1, every) != 0 || !is_known(field.q[at])) continue;
        cells.within(i, reach, found);
        for (const Neighbour& n : found) {
            const Order& q = field.q[static_cast<std::size_t>(n.index)];
            if (!is_known(q)) continue;
            const auto bin = static_cast<std::size_t>(std::sqrt(n.r2) / bin_width);
            if (bin >= bins_) continue;
            sample.sum[bin] += q.real() * field.q[at].real() + q.imag() * field.q[at].imag();
            sample.pairs[bin] += 1;
        }
    }
    return sample;
}

std::vector<OrderCorrelation::Known> OrderCorrelation::known(const Pattern& pattern,
                                                             const BondOrderField& field) {
    const auto part_of = [&](Vec2 p) {
        const Vec2 share{(p.x - pattern.box.origin.x) / pattern.box.length.x,
                         (p.y - pattern.box.origin.y) / pattern.box.length.y};
        const auto place = [](double x) {
            return std::clamp(static_cast<int>(x * parts_an_axis), 0, parts_an_axis - 1);
        };
        return static_cast<std::uint8_t>(place(share.y) * parts_an_axis + place(share.x));
    };
    std::vector<Known> order;
    order.reserve(pattern.id.size());
    for (std::size_t i = 0; i < pattern.id.size(); ++i) {
        if (!is_known(field.q[i])) continue;
        order.push_back({pattern.id[i], field.q[i], part_of(pattern.position[i])});
    }
    std::ranges::stable_sort(order, {}, &Known::id);
    return order;
}

bool OrderCorrelation::is_start(std::int64_t ordinal) const {
    return std::ranges::find(start_at_, ordinal) != start_at_.end();
}

bool OrderCorrelation::is_lag_after(std::int64_t start, std::int64_t ordinal) const {
    return std::ranges::find(lags_, ordinal - start) != lags_.end();
}

// Adds the pair of frames to the sums of its start and lag.
void OrderCorrelation::correlate(const Seen& start, const Seen& now) {
    const auto s = std::ranges::find(start_at_, start.ordinal) - start_at_.begin();
    const auto lag = std::ranges::find(lags_, now.ordinal - start.ordinal) - lags_.begin();
    LagSum& sums = of_start_[static_cast<std::size_t>(s)][static_cast<std::size_t>(lag)];
    sums.time += now.time - start.time;
    sums.frames += 1;
    auto next = now.order.begin();
    for (const Known& then : start.order) {
        while (next != now.order.end() && next->id < then.id) ++next;
        if (next == now.order.end()) break;
        if (next->id != then.id) continue;
        sums.product[then.part] += then.q.real() * next->q.real() + then.q.imag() * next->q.imag();
        sums.squares[then.part] += std::norm(then.q);
        sums.particles += 1;
    }
}

void OrderCorrelation::add(const Sample& sample, const Pattern& pattern,
                           const BondOrderField& field) {
    const std::int64_t ordinal = first_ + added_++;
    if (!sample.sum.empty()) {
        Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(ordinal / stride_))];
        ++chosen_;
        block.squares += sample.squares;
        block.particles += sample.particles;
        for (std::size_t b = 0; b < bins_; ++b) {
            block.sum[b] += sample.sum[b];
            block.pairs[b] += sample.pairs[b];
        }
    }
    if (pattern.id.empty()) {
        linked_ = linked_ && pattern.size() == 0;
        return;
    }
    const bool awaited = std::ranges::any_of(start_at_, [&](std::int64_t start) {
        return start < first_ && is_lag_after(start, ordinal);
    });
    const bool wanted = std::ranges::any_of(
        starts_, [&](const Seen& start) { return is_lag_after(start.ordinal, ordinal); });
    if (!awaited && !wanted && !is_start(ordinal)) return;
    const Seen now{ordinal, pattern.time, known(pattern, field)};
    for (const Seen& start : starts_) {
        if (is_lag_after(start.ordinal, ordinal)) correlate(start, now);
    }
    if (awaited) awaited_.push_back(now);
    if (is_start(ordinal)) starts_.push_back(now);
}

void OrderCorrelation::merge(const OrderCorrelation& later) {
    if (later.frames_ != frames_ || later.first_ != first_ + added_ || later.bins_ != bins_) {
        throw InputError(ErrorText{
            "the parts to merge are not consecutive parts of one run",
            fmt::format("frames from {} of {}", later.first_, later.frames_),
            fmt::format("frames from {} of {}", first_ + added_, frames_),
            "build each with the number of frames of the whole and that of its first frame"});
    }
    added_ += later.added_;
    chosen_ += later.chosen_;
    linked_ = linked_ && later.linked_;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        blocks_[b].squares += later.blocks_[b].squares;
        blocks_[b].particles += later.blocks_[b].particles;
        for (std::size_t i = 0; i < bins_; ++i) {
            blocks_[b].sum[i] += later.blocks_[b].sum[i];
            blocks_[b].pairs[i] += later.blocks_[b].pairs[i];
        }
    }
    for (const Seen& start : starts_) {
        for (const Seen& now : later.awaited_) {
            if (is_lag_after(start.ordinal, now.ordinal)) correlate(start, now);
        }
    }
    for (std::size_t s = 0; s < of_start_.size(); ++s) {
        if (start_at_[s] < later.first_) continue;
        of_start_[s] = later.of_start_[s];
    }
    starts_.insert(starts_.end(), later.starts_.begin(), later.starts_.end());
    for (const Seen& now : later.awaited_) {
        const bool before_both = std::ranges::any_of(start_at_, [&](std::int64_t start) {
            return start < first_ && is_lag_after(start, now.ordinal);
        });
        if (before_both) awaited_.push_back(now);
    }
}

void OrderCorrelation::add_space(ObservableResult& result) const {
    const std::size_t none = blocks_.size();
    const auto curve_without = [&](std::size_t without) {
        Block all{0, 0, std::vector<double>(bins_, 0.0), std::vector<double>(bins_, 0.0)};
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            if (b == without) continue;
            all.squares += blocks_[b].squares;
            all.particles += blocks_[b].particles;
            for (std::size_t i = 0; i < bins_; ++i) {
                all.sum[i] += blocks_[b].sum[i];
                all.pairs[i] += blocks_[b].pairs[i];
            }
        }
        std::vector<double> c(bins_, undefined);
        for (std::size_t i = 0; i < bins_ && all.squares > 0; ++i) {
            if (all.pairs[i] < least_pairs) continue;
            c[i] = all.sum[i] / all.pairs[i] / (all.squares / all.particles);
        }
        return std::pair(c, all);
    };
    const auto [c, all] = curve_without(none);
    std::vector<std::vector<double>> left;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (blocks_[b].particles > 0) left.push_back(curve_without(b).first);
    }
    Curve curve{"q4_space",
                "Correlation of the order in space",
                {{"r", "a", "Distance", {}},
                 {"c", "-", "Correlation of the order", {}},
                 {"err", "-", "Standard error", {}},
                 {"n", "-", "Pairs", {}}},
                {}};
    for (std::size_t i = 0; i < bins_; ++i) {
        if (!std::isfinite(c[i])) continue;
        std::vector<double> values;
        for (const std::vector<double>& part : left) values.push_back(part[i]);
        curve.columns[0].values.push_back((static_cast<double>(i) + 0.5) * bin_width);
        curve.columns[1].values.push_back(c[i]);
        curve.columns[2].values.push_back(left_out_error(values).error.value_or(undefined));
        curve.columns[3].values.push_back(all.pairs[i]);
    }
    if (curve.columns[0].values.empty()) {
        result.measurements.push_back(missing("order_length", "a", "too few pairs of particles"));
        return;
    }
    std::vector<double> r;
    for (std::size_t i = 0; i < bins_; ++i) r.push_back((static_cast<double>(i) + 0.5) * bin_width);
    std::vector<double> lengths;
    for (const std::vector<double>& part : left) lengths.push_back(fall(r, part));
    result.measurements.push_back(length_measured(fall(r, c), lengths, chosen_));
    result.curves.push_back(std::move(curve));
}

// C of each lag without a starting frame or (both: and) without a part of the box.
std::vector<double> OrderCorrelation::correlation_in_time(std::size_t without_start,
                                                          std::size_t without_part,
                                                          bool both) const {
    std::vector<double> c(lags_.size(), undefined);
    for (std::size_t l = 0; l < lags_.size(); ++l) {
        double product = 0;
        double squares = 0;
        for (std::size_t s = 0; s < of_start_.size(); ++s) {
            for (std::size_t p = 0; p < parts; ++p) {
                const bool start_out = s == without_start;
                const bool part_out = p == without_part;
                if (both ? start_out && part_out : start_out || part_out) continue;
                product += of_start_[s][l].product[p];
                squares += of_start_[s][l].squares[p];
            }
        }
        if (squares > 0) c[l] = product / squares;
    }
    return c;
}

void OrderCorrelation::add_time(ObservableResult& result) const {
    if (!linked_ || starts_.empty() || lags_.empty()) {
        result.measurements.push_back(
            missing("order_time", "time unit",
                    linked_ ? "too few frames" : "the particles are not linked"));
        return;
    }
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    const std::vector<double> c = correlation_in_time(none, none, false);
    // With each starting frame, part of the box and piece left out that holds any particle.
    std::vector<std::vector<double>> left_starts, left_parts, left_pieces;
    std::array<bool, parts> filled{};
    for (std::size_t s = 0; s < of_start_.size(); ++s) {
        bool any = false;
        for (std::size_t p = 0; p < parts; ++p) {
            const bool piece = std::ranges::any_of(
                of_start_[s], [p](const LagSum& sums) { return sums.squares[p] > 0; });
            if (piece) left_pieces.push_back(correlation_in_time(s, p, true));
            filled[p] = filled[p] || piece;
            any = any || piece;
        }
        if (any) left_starts.push_back(correlation_in_time(s, none, false));
    }
    for (std::size_t p = 0; p < parts; ++p) {
        if (filled[p]) left_parts.push_back(correlation_in_time(none, p, false));
    }
    const auto error_of = [&](auto&& number) {
        std::array<std::vector<double>, 3> left;
        for (const auto& part : left_starts) left[0].push_back(number(part));
        for (const auto& part : left_parts) left[1].push_back(number(part));
        for (const auto& part : left_pieces) left[2].push_back(number(part));
        return time_error(left[0], left[1], left[2]);
    };
    Curve curve{"q4_time",
                "Correlation of the order in time",
                {{"t", "time unit", "Lag time", {}},
                 {"c", "-", "Correlation of the order", {}},
                 {"err", "-", "Standard error", {}},
                 {"n", "-", "Particles", {}}},
                {}};
    std::vector<double> times(lags_.size(), undefined);
    for (std::size_t l = 0; l < lags_.size(); ++l) {
        if (!std::isfinite(c[l])) continue;
        LagSum all;
        for (const std::vector<LagSum>& start : of_start_) {
            all.time += start[l].time;
            all.frames += start[l].frames;
            all.particles += start[l].particles;
        }
        times[l] = all.time / all.frames;
        const TimeError found = error_of([l](const std::vector<double>& part) { return part[l]; });
        curve.columns[0].values.push_back(times[l]);
        curve.columns[1].values.push_back(c[l]);
        curve.columns[2].values.push_back(found.error.value_or(undefined));
        curve.columns[3].values.push_back(all.particles);
    }
    if (curve.columns[0].values.empty()) {
        result.measurements.push_back(
            missing("order_time", "time unit", "no particle with an order is seen twice"));
        return;
    }
    const double value = fall(times, c);
    const TimeError found =
        error_of([&](const std::vector<double>& part) { return fall(times, part); });
    Measurement m{"order_time", "time unit", std::nullopt, std::nullopt, 0, ""};
    if (!std::isfinite(value)) {
        m.reason = "the correlation stays above 1/e up to half of the run";
    } else if (curve.columns[1].values.front() < 1 / std::numbers::e) {
        m.reason = fmt::format(
            "below 1/e already at {:.3g}, the shortest time between frames: they are too far apart",
            curve.columns[0].values.front());
    } else {
        m.value = value;
        m.error = found.error;
        m.samples = found.samples;
        if (!m.error) m.reason = "too few independent pieces of box and run for an error";
    }
    result.measurements.push_back(std::move(m));
    result.curves.push_back(std::move(curve));
}

void OrderCorrelation::add_to(ObservableResult& result) const {
    if (!result.reason.empty()) return;
    add_space(result);
    add_time(result);
}

}  // namespace grainfield::analysis
