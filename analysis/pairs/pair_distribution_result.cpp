#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/pairs/pair_distribution.h"
#include "analysis/recorded_options.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double least_peak = 0.5;      // nearer pairs are no neighbours [a]
constexpr double least_pairs = 20;      // of a bin that can be the peak
constexpr double least_known = 0.9;     // share of heights that contacts need
constexpr double most_too_near = 0.05;  // share of spheres

}  // namespace

std::vector<double> PairDistribution::errors(const Block& all, Sums Block::*sums) const {
    std::vector<double> error(bins_, undefined);
    const auto used = std::ranges::count_if(blocks_, [](const Block& b) { return b.frames > 0; });
    const Sums& whole = all.*sums;
    for (std::size_t bin = 0; bin < bins_; ++bin) {
        if (used < 4) {
            const auto n = static_cast<double>(whole.pairs[bin]);
            if (n > 0) error[bin] = whole.weight[bin] / whole.expected[bin] / std::sqrt(n);
            continue;
        }
        std::vector<double> left;
        for (const Block& block : blocks_) {
            if (block.frames == 0) continue;
            const Sums& part = block.*sums;
            left.push_back((whole.weight[bin] - part.weight[bin]) /
                           (whole.expected[bin] - part.expected[bin]));
        }
        if (whole.pairs[bin] > 0) error[bin] = left_out_error(left).error.value_or(undefined);
    }
    return error;
}

Curve PairDistribution::curve(const Block& all, Sums Block::*sums, const char* name,
                              const char* title, const char* distance) const {
    Curve curve{name,
                title,
                {{distance, "a", "Distance", {}},
                 {"g", "-", "Pair distribution", {}},
                 {"err", "-", "Standard error", errors(all, sums)},
                 {"n", "-", "Pairs", {}}},
                {}};
    const Sums& whole = all.*sums;
    for (std::size_t bin = 0; bin < bins_; ++bin) {
        const double expected = whole.expected[bin];
        curve.columns[0].values.push_back((static_cast<double>(bin) + 0.5) * options_.bin);
        curve.columns[1].values.push_back(expected > 0 ? whole.weight[bin] / expected : undefined);
        curve.columns[3].values.push_back(static_cast<double>(whole.pairs[bin]));
    }
    return curve;
}

void PairDistribution::add_space(const Block& all, ObservableResult& result) const {
    const std::string unknown = "heights are not known";
    if (all.known < 2) {
        result.measurements.push_back(missing("contact_number", "-", unknown));
        return;
    }
    Curve space = curve(all, &Block::space, "gr_space", "Pair distribution in space", "r");
    Column neighbours{"neighbours", "-", "Mean number of spheres within r", {}};
    double within = 0;
    for (const double weight : all.space.weight) {
        within += weight;
        neighbours.values.push_back(within / all.known);
    }
    space.columns.push_back(std::move(neighbours));
    result.curves.push_back(std::move(space));

    Curve contacts{"contacts",
                   "Contacts of a sphere",
                   {{"n", "-", "Contacts", {}}, {"share", "-", "Share of spheres", {}}},
                   {}};
    double spheres = 0;
    for (const std::int64_t count : all.spheres_with) spheres += static_cast<double>(count);
    if (!(spheres > 0)) {
        result.measurements.push_back(
            missing("contact_number", "-", "no sphere further from a wall than a contact"));
        return;
    }
    std::size_t last = most_contacts;
    while (last > 0 && all.spheres_with[last] == 0) --last;
    for (std::size_t n = 0; n <= last; ++n) {
        contacts.columns[0].values.push_back(static_cast<double>(n));
        contacts.columns[1].values.push_back(static_cast<double>(all.spheres_with[n]) / spheres);
    }
    result.curves.push_back(std::move(contacts));

    const auto sum = static_cast<double>(all.contacts);
    std::vector<double> left;
    for (const Block& block : blocks_) {
        if (block.frames == 0) continue;
        double rest = spheres;
        for (const std::int64_t count : block.spheres_with) rest -= static_cast<double>(count);
        left.push_back((sum - static_cast<double>(block.contacts)) / rest);
    }
    const SeriesError error = left_out_error(left);
    const double share_known = all.known / all.particles;
    const double share_near = static_cast<double>(all.too_near) / spheres;
    result.measurements.push_back(
        share_known < least_known
            ? missing("contact_number", "-",
                      fmt::format("{:.0f} % of the heights are known", 100 * share_known))
        : share_near > most_too_near
            ? missing("contact_number", "-",
                      fmt::format("heights are off: {:.0f} % of the spheres are nearer than {} a "
                                  "to another",
                                  100 * share_near, too_near))
            : measured("contact_number", "-", sum / spheres, error.error, spheres, error.reason));
    result.measurements.push_back(measured("share_too_near", "-", share_near, std::nullopt, spheres,
                                           "a check of heights: no error"));
    result.measurements.push_back(measured("known_heights", "-", share_known, std::nullopt,
                                           all.particles, "counted: no error"));
}

void PairDistribution::add_peak(const Curve& plane, ObservableResult& result) const {
    const std::vector<double>& g = plane.columns[1].values;
    std::optional<std::size_t> peak;
    for (std::size_t bin = 0; bin < g.size(); ++bin) {
        const bool counts = plane.columns[0].values[bin] >= least_peak &&
                            plane.columns[3].values[bin] >= least_pairs;
        if (counts && (!peak || g[bin] > g[*peak])) peak = bin;
    }
    if (!peak) {
        result.measurements.push_back(
            missing("gr_peak", "-",
                    fmt::format("no bin beyond {} a holds {} pairs", least_peak, least_pairs)));
        return;
    }
    const double pairs = plane.columns[3].values[*peak];
    result.measurements.push_back(measured("gr_peak", "-", g[*peak], std::nullopt, pairs,
                                           "the largest of the bins: no error"));
    result.measurements.push_back(measured("gr_peak_distance", "a", plane.columns[0].values[*peak],
                                           std::nullopt, pairs, "the middle of a bin: no error"));
}

ObservableResult PairDistribution::result() const {
    ObservableResult result;
    result.name = "gr";
    PairDistributionOptions options = options_;
    result.options = recorded(describe(options));
    const Block all = total();
    if (added_ == 0 || all.particles < 2) {
        result.reason =
            added_ == 0 ? "no frames"
            : bins_ == 0
                ? fmt::format("half the window is narrower than a bin of {:.3g} a", options_.bin)
                : "fewer than two particles in the window";
        return result;
    }
    result.curves.push_back(curve(all, &Block::plane, "gr", "Pair distribution in the plane", "s"));
    add_peak(Curve(result.curves.front()), result);
    add_space(all, result);
    return result;
}

}  // namespace grainfield::analysis
