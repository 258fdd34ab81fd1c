#include "analysis/order/bond_statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/order/histogram_modes.h"
#include "analysis/recorded_options.h"

namespace grainfield::analysis {
namespace {

constexpr int bins = 50;
constexpr std::size_t most_blocks = 32;

struct Mean {
    double sum = 0;
    double squares = 0;
    double count = 0;

    void add(double x) {
        sum += x;
        squares += x * x;
        count += 1;
    }
    double mean() const { return sum / count; }
    double error() const {
        if (count < 2) return 0;
        return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / (count - 1));
    }
};

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::optional<double> positive(double error) {
    return error > 0 ? std::optional<double>(error) : std::nullopt;
}

// Whether particle i and all its neighbours are ordered.
bool inside_crystal(const BondOrderField& field, const std::vector<double>& abs_q, std::size_t i,
                    double ordered) {
    if (!(abs_q[i] >= ordered)) return false;
    const auto count = static_cast<std::size_t>(field.neighbours[i]);
    for (std::size_t n = field.first[i]; n < field.first[i] + count; ++n) {
        if (!(abs_q[static_cast<std::size_t>(field.neighbour[n])] >= ordered)) return false;
    }
    return true;
}

}  // namespace

BondStatistics::BondStatistics(const BondOrderOptions& options, double solid_above)
    : options_(options), solid_above_(solid_above), histogram_(bins, 0.0), squares_(bins, 0.0) {}

BondStatistics::Sample BondStatistics::measure(const Pattern& pattern,
                                               const BondOrderOptions& options) {
    return {pattern.frame, pattern.id,
            std::make_shared<const BondOrderField>(bond_order(pattern, options))};
}

void BondStatistics::add(Sample sample) {
    const BondOrderField& field = *sample.field;
    Mean order;
    Mean nearest;
    std::vector<double> spacing;
    std::vector<double> counts(bins, 0.0);
    std::vector<double> abs_q(field.q.size());
    std::ranges::transform(field.q, abs_q.begin(),
                           [](const std::complex<double>& q) { return std::sqrt(std::norm(q)); });
    for (std::size_t i = 0; i < abs_q.size(); ++i) {
        const double q = abs_q[i];
        if (std::isfinite(field.nearest[i])) nearest.add(field.nearest[i]);
        if (!std::isfinite(q)) continue;
        order.add(q);
        const int bin = std::min(static_cast<int>(q * bins), bins - 1);
        counts[static_cast<std::size_t>(bin)] += 1;
        if (inside_crystal(field, abs_q, i, solid_above_) && std::isfinite(field.mean_four[i])) {
            spacing.push_back(field.mean_four[i]);
        }
    }
    ++frames_;
    defined_ += order.count;
    if (blocks_.empty() || blocks_.back().frames >= block_length_) {
        if (blocks_.size() == most_blocks) halve_blocks();
        blocks_.push_back({0, std::vector<double>(bins, 0.0)});
    }
    blocks_.back().frames += 1;
    for (std::size_t b = 0; b < counts.size(); ++b) {
        histogram_[b] += counts[b];
        squares_[b] += counts[b] * counts[b];
        blocks_.back().counts[b] += counts[b];
    }
    if (order.count > 0) {
        mean_.add(order.mean());
        single_spread_ = order.error();
        single_count_ = order.count;
    }
    if (nearest.count > 0) {
        nearest_.add(nearest.mean());
        single_nearest_ = nearest.error();
    }
    if (!spacing.empty()) {
        Mean spread;
        for (double s : spacing) spread.add(s);
        spacing_.add(median(spacing));
        // The median of a normal sample is sqrt(pi/2) times less precise than its mean.
        single_spacing_ = 1.2533 * spread.error();
        single_inside_ = spread.count;
    }
    last_ = std::move(sample);
}

void BondStatistics::merge(const BondStatistics& later) {
    for (std::size_t b = 0; b < histogram_.size(); ++b) {
        histogram_[b] += later.histogram_[b];
        squares_[b] += later.squares_[b];
    }
    blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
    block_length_ = std::max(block_length_, later.block_length_);
    while (blocks_.size() > most_blocks) halve_blocks();
    mean_.append(later.mean_);
    nearest_.append(later.nearest_);
    spacing_.append(later.spacing_);
    frames_ += later.frames_;
    defined_ += later.defined_;
    if (later.frames_ > 0) {
        single_spread_ = later.single_spread_;
        single_nearest_ = later.single_nearest_;
        single_spacing_ = later.single_spacing_;
        single_count_ = later.single_count_;
        single_inside_ = later.single_inside_;
        last_ = later.last_;
    }
}

std::vector<BondStatistics::Block> BondStatistics::joined_in_pairs(
    const std::vector<Block>& blocks) {
    std::vector<Block> joined;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (b % 2 == 0) {
            joined.push_back(blocks[b]);
            continue;
        }
        joined.back().frames += blocks[b].frames;
        for (std::size_t j = 0; j < blocks[b].counts.size(); ++j) {
            joined.back().counts[j] += blocks[b].counts[j];
        }
    }
    return joined;
}

void BondStatistics::halve_blocks() {
    blocks_ = joined_in_pairs(blocks_);
    block_length_ *= 2;
}

double BondStatistics::independent_frames() const {
    const auto frames = static_cast<double>(frames_);
    if (frames_ < 4 || defined_ <= 0) return 1;
    double expected = 0;
    double expected_squares = 0;
    double of_frames = 0;
    for (std::size_t j = 0; j < histogram_.size(); ++j) {
        const double mean = histogram_[j] / frames;
        const double binomial = mean * (1 - histogram_[j] / defined_);
        expected += binomial;
        expected_squares += binomial * binomial;
        of_frames += (squares_[j] - frames * mean * mean) / (frames - 1);
    }
    // Blocks of growing length, as long as there are eight of them: the longest correlation shows.
    double of_blocks = 0;
    for (std::vector<Block> blocks = blocks_; blocks.size() >= 8;
         blocks = joined_in_pairs(blocks)) {
        double variance = 0;
        for (const Block& block : blocks) {
            for (std::size_t j = 0; j < histogram_.size(); ++j) {
                const double d = block.counts[j] - block.frames * histogram_[j] / frames;
                variance += d * d / block.frames / (static_cast<double>(blocks.size()) - 1);
            }
        }
        of_blocks = std::max(of_blocks, variance);
    }
    of_blocks = std::max(of_blocks, of_frames);
    if (!(expected > 0)) return 1;
    const double changing = of_frames / expected;
    // Two standard errors of `changing` for independent frames: below that nothing is constant.
    const double noise = 2 * std::sqrt(2 * expected_squares / (expected * expected) / (frames - 1));
    const double constant = std::max(0.0, 1 - changing - noise);
    return std::clamp(1 / (constant + of_blocks / expected / frames), 1.0, frames);
}

Curve BondStatistics::histogram_curve() const {
    Curve curve;
    curve.name = "q4_histogram";
    curve.title = fmt::format("Distribution of |Q{}|", options_.symmetry);
    Column q{"q4", "-", fmt::format("|Q{}|", options_.symmetry), {}};
    Column density{"density", "-", "Probability density", {}};
    Column count{"count", "-", "Particles", {}};
    Column error{"err", "-", "Standard error of the density", {}};
    const double independent = defined_ > 0
                                   ? independent_frames() * defined_ / static_cast<double>(frames_)
                                   : 0;  // particles
    for (int b = 0; b < bins; ++b) {
        const double particles = histogram_[static_cast<std::size_t>(b)];
        const double share = defined_ > 0 ? particles / defined_ : 0;
        q.values.push_back((b + 0.5) / bins);
        density.values.push_back(share * bins);
        count.values.push_back(particles);
        error.values.push_back(independent > 0 ? bins * std::sqrt(share * (1 - share) / independent)
                                               : 0);
    }
    curve.columns = {q, density, count, error};
    return curve;
}

Curve BondStatistics::field_curve() const {
    Curve curve;
    curve.name = "q4";
    curve.title = fmt::format("Q{} of each particle in the last frame", options_.symmetry);
    Column frame{"frame", "-", "Frame", {}};
    Column particle{"particle", "-", "Particle", {}};
    Column re{"q4_re", "-", "Real part", {}};
    Column im{"q4_im", "-", "Imaginary part", {}};
    Column neighbours{"n_neighbours", "-", "Neighbours", {}};
    for (std::size_t i = 0; i < last_.field->q.size(); ++i) {
        frame.values.push_back(static_cast<double>(last_.frame));
        particle.values.push_back(
            static_cast<double>(last_.id.empty() ? static_cast<std::int64_t>(i) : last_.id[i]));
        re.values.push_back(last_.field->q[i].real());
        im.values.push_back(last_.field->q[i].imag());
        neighbours.values.push_back(last_.field->neighbours[i]);
    }
    curve.columns = {frame, particle, re, im, neighbours};
    return curve;
}

void BondStatistics::add_modes(ObservableResult& result) const {
    const double share = independent_frames() / static_cast<double>(frames_);
    const HistogramModes modes = find_modes(histogram_, share);
    const auto mode = [&](const char* name, const std::optional<double>& value,
                          const std::optional<double>& error) {
        Measurement m{order_name(options_.symmetry, name), "-", value, error, defined_ * share, ""};
        if (!value) {
            m.samples = 0;
            m.reason = modes.reason;
        } else if (!error) {
            m.reason = "at the edge of the histogram or too flat for an error";
        } else if (frames_ > 1 && frames_ < 4) {
            m.reason = "fewer than four frames: error as if they were one";
        }
        result.measurements.push_back(m);
    };
    mode("low_mode", modes.low_mode, modes.low_mode_error);
    mode("high_mode", modes.high_mode, modes.high_mode_error);
    mode("minimum", modes.minimum, modes.minimum_error);
}

void BondStatistics::add_measurements(ObservableResult& result) const {
    const std::string one = "one frame: error takes particles as independent";
    const auto say = [&](const MeanSeries& series, const std::string& name, const char* unit,
                         double error, double count) {
        result.measurements.push_back(series.measurement(name, unit, positive(error), one, count));
        Measurement& m = result.measurements.back();
        if (m.value && !m.error && frames_ == 1) m.reason = "all the same: no error";
    };
    say(mean_, order_name(options_.symmetry, "mean"), "-", single_spread_, single_count_);
    add_modes(result);
    say(nearest_, "nearest_distance", "a", single_nearest_, single_count_);
    if (spacing_.value.empty()) {
        result.measurements.push_back(
            missing("lattice_spacing", "a",
                    fmt::format("no particle has |Q{}| of {} or more together with its neighbours",
                                options_.symmetry, solid_above_)));
    } else {
        say(spacing_, "lattice_spacing", "a", single_spacing_, single_inside_);
    }
}

ObservableResult BondStatistics::result() const {
    ObservableResult result;
    result.name = "q4";
    BondOrderOptions options = options_;
    result.options = recorded(describe(options));
    if (defined_ <= 0) {
        result.reason = frames_ == 0 ? "no frames" : "no particle has a neighbour in any frame";
        return result;
    }
    add_measurements(result);
    result.curves = {histogram_curve(), field_curve()};
    return result;
}

}  // namespace grainfield::analysis
