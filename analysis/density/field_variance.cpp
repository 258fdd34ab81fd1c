#include "analysis/density/field_variance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {

FieldVariance::FieldVariance(const DensityField& field, int dimension, const BlockPlan& instants,
                             std::int64_t replicas)
    : dimension_(dimension), spacing_(field.spacing), plan_(instants), replicas_(replicas) {
    const int shorter = dimension == 1 ? field.nx : std::min(field.nx, field.ny);
    for (int power = 1; power <= shorter / 2; power *= 2) {
        sizes_.push_back(power);
        const int between = power + power / 2;
        if (power > 1 && between <= shorter / 2) sizes_.push_back(between);
    }
    sums_.assign(static_cast<std::size_t>(plan_.blocks), std::vector<double>(1 + sizes_.size(), 0));
}

double FieldVariance::mean_square(const DensityField& field, int m, double mean) const {
    const auto nx = static_cast<std::size_t>(field.nx);
    const int rows = dimension_ == 1 ? 1 : m;
    const auto row = [&](int y) {
        return &field.value[static_cast<std::size_t>(y % field.ny) * nx];
    };
    std::vector<double> column(nx, 0);  // content of the rows of the window, column by column
    for (int y = 0; y < rows; ++y) {
        for (std::size_t x = 0; x < nx; ++x) column[x] += row(y)[x] - mean;
    }
    double squares = 0;
    for (int y = 0; y < field.ny; ++y) {
        double content = std::accumulate(column.begin(), column.begin() + m, 0.0);
        std::size_t enters = static_cast<std::size_t>(m) % nx;
        for (std::size_t x = 0; x < nx; ++x) {
            squares += content * content;
            content += column[enters] - column[x];
            enters = enters + 1 == nx ? 0 : enters + 1;
        }
        if (dimension_ == 1) continue;
        const double* out = row(y);
        const double* in = row(y + rows);
        for (std::size_t x = 0; x < nx; ++x) column[x] += in[x] - out[x];
    }
    return squares / static_cast<double>(field.size());
}

std::vector<double> FieldVariance::measure(const DensityField& field) const {
    const double mean = std::accumulate(field.value.begin(), field.value.end(), 0.0) /
                        static_cast<double>(field.size());
    const double cell = std::pow(spacing_, dimension_);
    std::vector<double> sample;
    for (int m : sizes_) sample.push_back(cell * cell * mean_square(field, m, mean));
    return sample;
}

void FieldVariance::add(const std::vector<double>& sample) {
    std::vector<double>& sums =
        sums_[static_cast<std::size_t>(plan_.block_of(added_++ / replicas_))];
    sums[0] += 1;
    for (std::size_t s = 0; s < sample.size(); ++s) sums[s + 1] += sample[s];
}

ObservableResult FieldVariance::result() const {
    ObservableResult result;
    result.name = "variance";
    if (added_ == 0 || sizes_.empty()) {
        result.reason = added_ == 0 ? "no fields" : "no window fits twice into the lattice";
        return result;
    }
    Curve curve{"variance",
                "Variance of the content of windows",
                {{"l", "l", "Window side", {}},
                 {"variance", "-", "Variance of the content", {}},
                 {"err", "-", "Standard error", {}},
                 {"mean", "l^d", "Window volume", {}}},
                {}};
    double frames = 0;
    double filled = 0;  // blocks
    for (const auto& block : sums_) {
        frames += block[0];
        filled += block[0] > 0 ? 1 : 0;
    }
    SeriesError found;
    for (std::size_t s = 0; s < sizes_.size(); ++s) {
        double sum = 0;
        for (const auto& block : sums_) sum += block[s + 1];
        std::vector<double> left;
        for (const auto& block : sums_) {
            if (block[0] <= 0) continue;  // of a run that was cut short
            left.push_back(frames > block[0] ? (sum - block[s + 1]) / (frames - block[0])
                                             : std::numeric_limits<double>::quiet_NaN());
        }
        const double side = sizes_[s] * spacing_;
        curve.columns[0].values.push_back(side);
        curve.columns[1].values.push_back(sum / frames);
        found = left_out_error(left);
        curve.columns[2].values.push_back(
            found.error.value_or(std::numeric_limits<double>::quiet_NaN()));
        curve.columns[3].values.push_back(std::pow(side, dimension_));
    }
    const double volume = curve.columns[3].values.back();
    const double error = curve.columns[2].values.back() / volume;
    Measurement largest{"variance_per_volume", "-",    curve.columns[1].values.back() / volume,
                        std::nullopt,          filled, ""};
    if (std::isfinite(error)) {
        largest.error = error;
    } else {
        largest.reason = filled < 4 ? too_few_blocks : found.reason;
    }
    result.measurements = {largest};
    result.curves = {std::move(curve)};
    return result;
}

void FieldVariance::save(Checkpoint& checkpoint, const std::string& prefix) const {
    checkpoint.integers[prefix + "added"] = {added_};
    for (std::size_t b = 0; b < sums_.size(); ++b) {
        checkpoint.reals[prefix + std::to_string(b)] = sums_[b];
    }
}

void FieldVariance::restore(const Checkpoint& checkpoint, const std::string& prefix) {
    const auto added = checkpoint.integers.find(prefix + "added");
    bool fits = added != checkpoint.integers.end() && added->second.size() == 1;
    for (std::size_t b = 0; b < sums_.size() && fits; ++b) {
        const auto found = checkpoint.reals.find(prefix + std::to_string(b));
        fits = found != checkpoint.reals.end() && found->second.size() == sums_[b].size();
        if (fits) sums_[b] = found->second;
    }
    if (!fits) throw InputError(fmt::format("the checkpoint does not fit: '{}'.", prefix));
    added_ = added->second[0];
}

void FieldVariance::lengthen(const BlockPlan& plan) {
    sums_ = lengthened_blocks(sums_, plan_, plan, std::vector<double>(1 + sizes_.size(), 0),
                              [](std::vector<double>& to, const std::vector<double>& from) {
                                  std::ranges::transform(to, from, to.begin(), std::plus{});
                              });
    plan_ = plan;
}

}  // namespace grainfield::analysis
