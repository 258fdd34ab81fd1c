#include "analysis/order_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "analysis/neighbours.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double bin_width = 0.1;
constexpr std::int64_t most_frames = 32;
constexpr std::int64_t most_starts = 16;
constexpr std::size_t most_centres = 2000;
constexpr double least_pairs = 20;  // in a bin that is shown

bool is_known(const std::complex<double>& q) {
    return std::isfinite(q.real()) && std::isfinite(q.imag());
}

// Where y falls below 1/e for the first time, by a line between the points around it.
double fall(const std::vector<double>& x, const std::vector<double>& y) {
    const double level = std::exp(-1.0);
    double x_before = 0;
    double y_before = 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isfinite(y[i])) continue;
        if (y[i] < level) {
            return x_before + (x[i] - x_before) * (y_before - level) / (y_before - y[i]);
        }
        x_before = x[i];
        y_before = y[i];
    }
    return undefined;
}

Measurement fall_measured(const char* name, const char* unit, double value,
                          const std::vector<double>& left, double samples, const char* where) {
    if (!std::isfinite(value)) {
        return missing(name, unit, std::string("the correlation stays above 1/e ") + where);
    }
    Measurement m{name, unit, value, jackknife_error(left), samples, ""};
    if (!(m.error.value_or(0) > 0)) {
        m.error.reset();
        m.reason = "too few independent frames for an error";
    }
    return m;
}

}  // namespace

OrderCorrelation::OrderCorrelation(const Box& box, std::int64_t frames)
    : frames_(std::max<std::int64_t>(1, frames)),
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
    std::vector<Known> order;
    order.reserve(pattern.id.size());
    for (std::size_t i = 0; i < pattern.id.size(); ++i) {
        if (is_known(field.q[i])) order.push_back({pattern.id[i], field.q[i]});
    }
    std::ranges::stable_sort(order, {}, &Known::id);
    return order;
}

void OrderCorrelation::add(const Sample& sample, const Pattern& pattern,
                           const BondOrderField& field) {
    const std::int64_t ordinal = added_++;
    if (!sample.sum.empty()) {
        Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(chosen_++))];
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
    std::vector<Known> here;
    for (std::size_t s = 0; s < starts_.size(); ++s) {
        const auto lag = std::ranges::find(lags_, ordinal - starts_[s].ordinal);
        if (lag == lags_.end()) continue;
        if (here.empty()) here = known(pattern, field);
        LagSum& sums = of_start_[s][static_cast<std::size_t>(lag - lags_.begin())];
        sums.time += pattern.time - starts_[s].time;
        sums.frames += 1;
        auto next = here.begin();
        for (const Known& then : starts_[s].order) {
            while (next != here.end() && next->id < then.id) ++next;
            if (next == here.end()) break;
            if (next->id != then.id) continue;
            sums.product += then.q.real() * next->q.real() + then.q.imag() * next->q.imag();
            sums.squares += std::norm(then.q);
            sums.particles += 1;
        }
    }
    if (std::ranges::find(start_at_, ordinal) != start_at_.end()) {
        starts_.push_back({ordinal, pattern.time, here.empty() ? known(pattern, field) : here});
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
    for (std::size_t b = 0; b < blocks_.size(); ++b) left.push_back(curve_without(b).first);
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
        curve.columns[2].values.push_back(jackknife_error(values).value_or(undefined));
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
    result.measurements.push_back(fall_measured("order_length", "a", fall(r, c), lengths,
                                                static_cast<double>(chosen_), "up to 10 a"));
    result.curves.push_back(std::move(curve));
}

void OrderCorrelation::add_time(ObservableResult& result) const {
    if (!linked_ || starts_.empty() || lags_.empty()) {
        result.measurements.push_back(
            missing("order_time", "time unit",
                    linked_ ? "too few frames" : "the particles are not linked"));
        return;
    }
    const std::size_t none = of_start_.size();
    const auto curve_without = [&](std::size_t without) {
        std::vector<double> c(lags_.size(), undefined);
        for (std::size_t l = 0; l < lags_.size(); ++l) {
            double product = 0;
            double squares = 0;
            for (std::size_t s = 0; s < of_start_.size(); ++s) {
                if (s == without) continue;
                product += of_start_[s][l].product;
                squares += of_start_[s][l].squares;
            }
            if (squares > 0) c[l] = product / squares;
        }
        return c;
    };
    const std::vector<double> c = curve_without(none);
    std::vector<std::vector<double>> left;
    for (std::size_t s = 0; s < of_start_.size(); ++s) left.push_back(curve_without(s));
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
        std::vector<double> values;
        for (std::size_t s = 0; s < of_start_.size(); ++s) {
            all.time += of_start_[s][l].time;
            all.frames += of_start_[s][l].frames;
            all.particles += of_start_[s][l].particles;
            if (of_start_[s][l].frames > 0) values.push_back(left[s][l]);
        }
        times[l] = all.time / all.frames;
        curve.columns[0].values.push_back(times[l]);
        curve.columns[1].values.push_back(c[l]);
        curve.columns[2].values.push_back(jackknife_error(values).value_or(undefined));
        curve.columns[3].values.push_back(all.particles);
    }
    if (curve.columns[0].values.empty()) {
        result.measurements.push_back(
            missing("order_time", "time unit", "no particle with an order is seen twice"));
        return;
    }
    std::vector<double> falls;
    for (const std::vector<double>& part : left) falls.push_back(fall(times, part));
    result.measurements.push_back(fall_measured("order_time", "time unit", fall(times, c), falls,
                                                static_cast<double>(starts_.size()),
                                                "up to half of the run"));
    result.curves.push_back(std::move(curve));
}

void OrderCorrelation::add_to(ObservableResult& result) const {
    if (!result.reason.empty()) return;
    add_space(result);
    add_time(result);
}

}  // namespace grainfield::analysis
