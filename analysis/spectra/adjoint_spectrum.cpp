#include "analysis/spectra/adjoint_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "analysis/statistics/blocks.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr int least_blocks = 4;

struct Estimate {
    double s = undefined;
    double error = undefined;
    double samples = 0;
};

struct Sum {
    double of_s = 0;
    double count = 0;
};

// Waves of one length.
Estimate estimate(const std::vector<const WaveSamples*>& waves, double correlation_times) {
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const WaveSamples* wave : waves) fewest = std::min(fewest, wave->s.size());
    const double most = std::min({16.0, static_cast<double>(fewest), correlation_times});
    const auto blocks = static_cast<std::size_t>(std::max(1.0, std::floor(most)));
    std::vector<Sum> of_block(blocks);
    Sum all;
    for (const WaveSamples* wave : waves) {
        for (std::size_t i = 0; i < wave->s.size(); ++i) {
            Sum& block = of_block[i * blocks / wave->s.size()];
            for (Sum* sum : {&block, &all}) {
                sum->of_s += wave->s[i];
                sum->count += 1;
            }
        }
    }
    Estimate result;
    result.samples = all.count;
    if (all.count > 0) result.s = all.of_s / all.count;
    if (blocks < least_blocks) return result;
    std::vector<double> without;
    for (const Sum& block : of_block) {
        without.push_back((all.of_s - block.of_s) / (all.count - block.count));
    }
    if (const auto spread = student_jackknife_error(without, least_blocks)) result.error = *spread;
    return result;
}

}  // namespace

ObservableResult adjoint_spectrum(std::span<const WaveSamples> waves, double correlation_times) {
    std::map<double, std::vector<const WaveSamples*>> by_k;
    for (const WaveSamples& wave : waves) {
        by_k[std::round(wave.k * 1e12) / 1e12].push_back(&wave);
    }
    Curve curve{"sk",
                "Structure factor, adjoint",
                {{"k", "1/l", "Wavevector k", {}},
                 {"s", "-", "S(k)", {}},
                 {"s_err", "-", "Standard error of S(k)", {}},
                 {"n", "-", "Stretches", {}}},
                {}};
    ObservableResult result;
    result.name = "sk";
    for (const auto& [k, members] : by_k) {
        const Estimate e = estimate(members, correlation_times);
        if (result.measurements.empty()) {
            Measurement lowest{"s_lowest_k", "-", std::nullopt, std::nullopt, e.samples, ""};
            if (std::isfinite(e.s)) lowest.value = e.s;
            if (std::isfinite(e.error)) lowest.error = e.error;
            if (!lowest.value) {
                lowest.reason = "no stretch ended: make the run longer";
            } else if (!lowest.error) {
                lowest.reason =
                    "fewer than four stretches or correlation times 1/nu: no error; make the run "
                    "longer";
            }
            result.measurements.push_back(std::move(lowest));
        }
        const double row[] = {k, e.s, e.error, e.samples};
        for (std::size_t i = 0; i < curve.columns.size(); ++i) {
            curve.columns[i].values.push_back(row[i]);
        }
    }
    if (by_k.empty()) result.reason = "no wavevectors";
    result.curves = {std::move(curve)};
    return result;
}

}  // namespace grainfield::analysis
