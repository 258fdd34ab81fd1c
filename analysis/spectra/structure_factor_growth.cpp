#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/spectra/structure_factor.h"

// Whether S(k) is that of a steady state: how much it grows from the first third of a run to the
// last.

namespace grainfield::analysis {
namespace {

constexpr double least_waves = 4;         // of a range whose growth is told
constexpr double least_looks = 2;         // independent samples of one third
constexpr double largest_pull = 3.5;      // standard errors of ln(ratio)
constexpr double least_change = 0.1;      // of ln(ratio): a smaller one matters to no S0/S1
constexpr int halvings = 2;               // of the range: the lowest waves set S0
constexpr std::size_t least_blocks = 12;  // whose scatter is an error

double mean_of(const std::vector<double>& values) {
    return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

// Σ (x/mean − 1)².
double relative_squares(const std::vector<double>& values) {
    const double mean = mean_of(values);
    double squares = 0;
    for (const double value : values) squares += (value / mean - 1) * (value / mean - 1);
    return squares;
}

// Variance of ln(last/first) from the scatter of the blocks, with Student's factor.
double variance_of_blocks(const std::vector<double>& first, const std::vector<double>& last) {
    const auto a = static_cast<double>(first.size());
    const auto b = static_cast<double>(last.size());
    const double freedom = a + b - 2;
    const double each = (relative_squares(first) + relative_squares(last)) / freedom;
    return each * (1 / a + 1 / b) * freedom / (freedom - 2);
}

// A mean of n exponential numbers: ln of it has the variance 1/n + 1/(2 n²) + …
double variance_of_log(double n) {
    return 1 / n + 0.5 / (n * n);
}

// 1.061 ± 0.008: as many digits as the error has.
std::string with_error(double value, double error) {
    const int digits =
        error > 0 ? std::max(0, 1 - static_cast<int>(std::floor(std::log10(error)))) : 2;
    return fmt::format("{:.{}f} ± {:.{}f}", value, digits, error, digits);
}

}  // namespace

bool SpectrumGrowth::is_steady() const {
    const double change = std::abs(std::log(ratio));
    return change <= least_change || change <= largest_pull * error / ratio;
}

Measurement measured_growth(const std::string& symbol, const SpectrumGrowth& growth) {
    return {symbol + "_growth",
            "-",
            growth.ratio,
            growth.error,
            growth.samples,
            fmt::format("of the last third of the run over the first, up to k = {:.3g} /a",
                        growth.k_end)};
}

std::string not_steady(const std::string& symbol, const SpectrumGrowth& growth) {
    return fmt::format(
        "{} up to k = {:.3g} /a is {} times as large in the last third of the run as in the "
        "first: it is not steady; leave out the start (--frames), or run longer if it settles",
        symbol, growth.k_end, with_error(growth.ratio, growth.error));
}

// Mean square of a mode about its mean over the run, over the number of particles.
double StructureFactor::deviation(const Block& part, const Block& run, Estimator estimator,
                                  std::size_t mode) const {
    const double frames = part.frames;
    const double particles = part.particles / frames;
    if (estimator == Estimator::neumann) {
        const std::size_t c = neumann_index_[mode];
        const double mean = run.cosine[c] / run.frames;
        return (part.cosine2[c] / frames - 2 * mean * part.cosine[c] / frames + mean * mean) /
               particles;
    }
    double value = part.power[mode] / frames;
    for (std::size_t c = mode; estimator == Estimator::connected && c < part.rho.size();
         c += part.power.size()) {
        const std::complex<double> mean = run.rho[c] / run.frames;
        value += std::norm(mean) - 2 * std::real(std::conj(mean) * part.rho[c]) / frames;
    }
    return value / particles;
}

std::optional<SpectrumGrowth> StructureFactor::growth(Estimator estimator, double k_max) const {
    const std::vector<std::size_t> filled = filled_blocks();
    if (filled.size() < 3) return std::nullopt;
    const Block run = total(std::nullopt);
    // Blocks from each end, until they hold a third of the frames.
    std::vector<std::size_t> first;
    std::vector<std::size_t> last;
    double first_frames = 0;
    double last_frames = 0;
    for (std::size_t i = 0; first_frames < run.frames / 3 * (1 - 1e-9); ++i) {
        first.push_back(filled[i]);
        first_frames += blocks_[filled[i]].frames;
    }
    for (std::size_t i = filled.size(); last_frames < run.frames / 3 * (1 - 1e-9);) {
        last.push_back(filled[--i]);
        last_frames += blocks_[filled[i]].frames;
    }
    if (first.back() >= last.back()) return std::nullopt;

    const Spectrum spectrum = this->spectrum(estimator);
    const Shells shells = this->shells(estimator);
    const std::vector<double> waves = independent_modes(shells, estimator);
    const bool has_scatter = filled.size() >= least_blocks;
    // Fields of one instant are no independent ones, unless the scatter of blocks tells.
    const double replicas = has_scatter ? 1 : static_cast<double>(replicas_);

    std::optional<SpectrumGrowth> found;
    double largest = -1;
    double end = shells.k.empty() ? 0 : std::min(k_max, shells.k.back());
    for (int halving = 0; halving <= halvings; ++halving, end /= 2) {
        std::vector<double> of_first(first.size(), 0.0);
        std::vector<double> of_last(last.size(), 0.0);
        double weight = 0;
        double first_squares = 0;  // Σ weight²/looks
        double last_squares = 0;
        for (std::size_t i = 0; i < shells.k.size() && shells.k[i] <= end * (1 + 1e-12); ++i) {
            double of_run = 0;
            for (const std::size_t m : shells.members[i])
                of_run += deviation(run, run, estimator, m);
            if (!(of_run > 0) || !(spectrum.dof[i] > 0)) continue;
            const auto add = [&](const std::vector<std::size_t>& blocks, std::vector<double>& to) {
                for (std::size_t b = 0; b < blocks.size(); ++b) {
                    double s = 0;
                    for (const std::size_t m : shells.members[i]) {
                        s += deviation(blocks_[blocks[b]], run, estimator, m);
                    }
                    to[b] += waves[i] * s / of_run;
                }
            };
            add(first, of_first);
            add(last, of_last);
            // Slow modes of a periodic box: one look. Between walls they have no ν.
            const double one_look = estimator == Estimator::raw ? waves[i] : 0;
            const auto looks = [&](double frames) {
                return std::max(one_look, frames / run.frames * spectrum.dof[i] / replicas);
            };
            weight += waves[i];
            first_squares += waves[i] * waves[i] / looks(first_frames);
            last_squares += waves[i] * waves[i] / looks(last_frames);
        }
        if (weight < least_waves) continue;
        const double n_first = weight * weight / first_squares;
        const double n_last = weight * weight / last_squares;
        if (std::min(n_first, n_last) < least_looks) continue;
        const auto of_frames = [&](const std::vector<double>& values,
                                   const std::vector<std::size_t>& blocks, double frames) {
            double sum = 0;
            for (std::size_t b = 0; b < blocks.size(); ++b) {
                sum += values[b] * blocks_[blocks[b]].frames;
            }
            return sum / frames;
        };
        const double before = of_frames(of_first, first, first_frames);
        const double after = of_frames(of_last, last, last_frames);
        if (!(before > 0) || !(after > 0)) continue;
        double variance = variance_of_log(n_first) + variance_of_log(n_last);
        if (has_scatter) variance = std::max(variance, variance_of_blocks(of_first, of_last));
        const double ratio = after / before;
        const double pull = std::abs(std::log(ratio)) / std::sqrt(variance);
        if (pull <= largest) continue;
        largest = pull;
        found = SpectrumGrowth{ratio, ratio * std::sqrt(variance), end, std::min(n_first, n_last)};
    }
    return found;
}

}  // namespace grainfield::analysis
