#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
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

// The blocks of time at one end of a run that hold a third of its frames.
struct Third {
    std::vector<std::size_t> blocks;
    std::vector<double> frames_of_block;
    double frames = 0;
};

// One third of a run, a shell of waves or several.
struct Power {
    double k = 0;                  // of a shell
    double waves = 0;              // independent ones
    double looks = 0;              // independent samples
    std::vector<double> of_block;  // over the power of the run, summed over waves
};

// Looks are those of a mean that is weighted by waves.
Power power_up_to(double end, const std::vector<Power>& shells) {
    Power sum;
    double squares = 0;  // Σ waves²/looks
    for (const Power& shell : shells) {
        if (shell.k > end * (1 + 1e-12)) break;
        sum.of_block.resize(shell.of_block.size());
        std::transform(shell.of_block.begin(), shell.of_block.end(), sum.of_block.begin(),
                       sum.of_block.begin(), std::plus<>());
        sum.waves += shell.waves;
        squares += shell.waves * shell.waves / shell.looks;
    }
    if (squares > 0) sum.looks = sum.waves * sum.waves / squares;
    return sum;
}

double mean_over_frames(const Power& power, const Third& third) {
    return std::transform_reduce(power.of_block.begin(), power.of_block.end(),
                                 third.frames_of_block.begin(), 0.0) /
           third.frames;
}

// A third, and its shells.
struct ThirdPower {
    Third third;
    std::vector<Power> shells;
};

// Nothing where waves or looks are too few. has_scatter: blocks are enough for an error.
std::optional<SpectrumGrowth> growth_up_to(double end, const ThirdPower& first,
                                           const ThirdPower& last, bool has_scatter) {
    const Power of_first = power_up_to(end, first.shells);
    const Power of_last = power_up_to(end, last.shells);
    const double looks = std::min(of_first.looks, of_last.looks);
    if (of_first.waves < least_waves || looks < least_looks) return std::nullopt;
    const double before = mean_over_frames(of_first, first.third);
    const double after = mean_over_frames(of_last, last.third);
    if (!(before > 0) || !(after > 0)) return std::nullopt;
    double variance = variance_of_log(of_first.looks) + variance_of_log(of_last.looks);
    if (has_scatter) {
        variance = std::max(variance, variance_of_blocks(of_first.of_block, of_last.of_block));
    }
    const double ratio = after / before;
    return SpectrumGrowth{ratio, ratio * std::sqrt(variance), end, looks};
}

// Standard errors of ln(ratio) from no growth.
double pull_of(const SpectrumGrowth& growth) {
    return std::abs(std::log(growth.ratio)) * growth.ratio / growth.error;
}

// The largest ratio that passes as steady; its inverse is the smallest.
double largest_steady(const SpectrumGrowth& growth) {
    return std::exp(std::max(least_change, largest_pull * growth.error / growth.ratio));
}

// 1.061 ± 0.008: as many digits as the error has.
std::string with_error(double value, double error) {
    const int digits =
        error > 0 ? std::max(0, 1 - static_cast<int>(std::floor(std::log10(error)))) : 2;
    return fmt::format("{:.{}f} ± {:.{}f}", value, digits, error, digits);
}

}  // namespace

bool SpectrumGrowth::is_steady() const {
    return std::abs(std::log(ratio)) <= least_change || pull_of(*this) <= largest_pull;
}

Measurement measured_growth(const std::string& symbol, const SpectrumGrowth& growth) {
    return {
        symbol + "_growth",
        "-",
        growth.ratio,
        growth.error,
        growth.samples,
        fmt::format("of the last third of the run over the first, up to k = {:.3g} /a; {:.2g} to "
                    "{:.2g} passes as steady",
                    growth.k_end, 1 / largest_steady(growth), largest_steady(growth))};
}

std::string not_steady(const std::string& symbol, const SpectrumGrowth& growth) {
    return fmt::format(
        "{} up to k = {:.3g} /a is {} times as large in the last third of the run as in the "
        "first: it is not steady; run until it settles, then leave out the start (--frames). A "
        "shorter span alone only sees less growth",
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
    std::vector<std::size_t> filled = filled_blocks();
    if (filled.size() < 3) return std::nullopt;
    const Block run = total(std::nullopt);
    const auto third_from = [&](const std::vector<std::size_t>& in_order) {
        Third third;
        for (std::size_t i = 0; third.frames < run.frames / 3 * (1 - 1e-9); ++i) {
            const double frames = blocks_[in_order[i]].frames;
            third.blocks.push_back(in_order[i]);
            third.frames_of_block.push_back(frames);
            third.frames += frames;
        }
        return third;
    };
    const bool has_scatter = filled.size() >= least_blocks;
    ThirdPower first{third_from(filled), {}};
    std::reverse(filled.begin(), filled.end());
    ThirdPower last{third_from(filled), {}};
    if (first.third.blocks.back() >= last.third.blocks.back()) return std::nullopt;

    const Spectrum spectrum = this->spectrum(estimator);
    const Shells shells = this->shells(estimator);
    const std::vector<double> waves = independent_modes(shells, estimator);
    // Fields of one instant are no independent ones, unless the scatter of blocks tells.
    const double replicas = has_scatter ? 1 : static_cast<double>(replicas_);
    for (std::size_t i = 0; i < shells.k.size() && shells.k[i] <= k_max * (1 + 1e-12); ++i) {
        const auto power_of = [&](const Block& part) {
            double sum = 0;
            for (const std::size_t m : shells.members[i]) {
                sum += deviation(part, run, estimator, m);
            }
            return sum;
        };
        const double of_run = power_of(run);
        if (!(of_run > 0) || !(spectrum.dof[i] > 0)) continue;
        // Slow modes of a periodic box: one look. Between walls they have no ν.
        const double one_look = estimator == Estimator::raw ? waves[i] : 0;
        for (ThirdPower* part : {&first, &last}) {
            const double share = part->third.frames / run.frames;
            Power power{
                shells.k[i], waves[i], std::max(one_look, share * spectrum.dof[i] / replicas), {}};
            for (const std::size_t block : part->third.blocks) {
                power.of_block.push_back(waves[i] * power_of(blocks_[block]) / of_run);
            }
            part->shells.push_back(std::move(power));
        }
    }

    std::optional<SpectrumGrowth> found;
    double end = shells.k.empty() ? 0 : std::min(k_max, shells.k.back());
    for (int halving = 0; halving <= halvings; ++halving, end /= 2) {
        const auto growth = growth_up_to(end, first, last, has_scatter);
        if (growth && (!found || pull_of(*growth) > pull_of(*found))) found = growth;
    }
    return found;
}

}  // namespace grainfield::analysis
