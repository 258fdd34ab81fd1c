#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/spectra/structure_factor.h"

// Whether S(k) is that of a steady state: how much it grows from the first third of a run to the
// last.

namespace grainfield::analysis {
namespace {

constexpr double least_waves = 4;   // of a range whose growth is told
constexpr double least_looks = 2;   // independent samples of one third
constexpr double largest_pull = 3;  // standard errors of ln(ratio)
constexpr int halvings = 2;         // of the range: the lowest waves set S0

}  // namespace

bool SpectrumGrowth::is_steady() const {
    return std::abs(std::log(ratio)) <= largest_pull * error / ratio;
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
        "{} up to k = {:.3g} /a is {:.2g} ± {:.1g} times as large in the last third of the run as "
        "in the first: it is not steady; leave out the start (--frames), or run longer if it "
        "settles",
        symbol, growth.k_end, growth.ratio, growth.error);
}

std::optional<SpectrumGrowth> StructureFactor::growth(Estimator estimator, double k_max) const {
    const std::vector<std::size_t> filled = filled_blocks();
    const std::size_t third = filled.size() / 3;
    if (third == 0) return std::nullopt;
    std::vector<int> first(blocks_.size(), 0);
    std::vector<int> last(blocks_.size(), 0);
    for (std::size_t i = 0; i < third; ++i) {
        first[filled[i]] = 1;
        last[filled[filled.size() - 1 - i]] = 1;
    }
    const Spectrum of_run = spectrum(estimator);
    const Spectrum of_first = spectrum(estimator, first);
    const Spectrum of_last = spectrum(estimator, last);
    const std::vector<double> waves = independent_modes(shells(estimator), estimator);
    const double one_look = estimator == Estimator::neumann ? 0.5 : 1;  // of a real mode half
    const double share = static_cast<double>(third) / static_cast<double>(filled.size());

    std::optional<SpectrumGrowth> found;
    double largest = -1;
    double end = k_max;
    for (int halving = 0; halving <= halvings; ++halving, end /= 2) {
        double before = 0, after = 0, weight = 0, squares = 0;
        for (std::size_t i = 0; i < of_run.k.size() && of_run.k[i] <= end; ++i) {
            const double s = of_run.s[i];
            if (!(s > 0) || !(of_run.dof[i] > 0)) continue;
            if (!std::isfinite(of_first.s[i]) || !std::isfinite(of_last.s[i])) continue;
            before += waves[i] * of_first.s[i] / s;
            after += waves[i] * of_last.s[i] / s;
            weight += waves[i];
            const double looks = std::max(one_look * waves[i], share * of_run.dof[i]);
            squares += waves[i] * waves[i] / looks;
        }
        if (weight < least_waves || !(before > 0) || !(after > 0)) continue;
        // A mean of n exponential numbers: ln of it has the variance 1/n + 1/(2 n²) + …
        const double n = weight * weight / squares;
        if (n < least_looks) continue;
        const double ratio = after / before;
        const double spread = std::sqrt(2 * (1 / n + 0.5 / (n * n)));
        const double pull = std::abs(std::log(ratio)) / spread;
        if (pull <= largest) continue;
        largest = pull;
        found = SpectrumGrowth{ratio, ratio * spread, end, n};
    }
    return found;
}

}  // namespace grainfield::analysis
