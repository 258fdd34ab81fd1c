#include "analysis/order/solid_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace grainfield::analysis {
namespace {

// Root of a set of a forest, halving the paths.
int root_of(std::vector<int>& parent, int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
        int& up = parent[static_cast<std::size_t>(i)];
        up = parent[static_cast<std::size_t>(up)];
        i = up;
    }
    return i;
}

std::vector<int> clusters_of(const SolidClusters::Frame& frame) {
    std::vector<int> parent(frame.solid.size());
    std::iota(parent.begin(), parent.end(), 0);
    const BondOrderField& field = *frame.field;
    for (std::size_t i = 0; i < parent.size(); ++i) {
        if (!frame.solid[i]) continue;
        const auto count = static_cast<std::size_t>(field.neighbours[i]);
        for (std::size_t n = field.first[i]; n < field.first[i] + count; ++n) {
            const int j = field.neighbour[n];
            if (!frame.solid[static_cast<std::size_t>(j)]) continue;
            const int a = root_of(parent, static_cast<int>(i));
            const int b = root_of(parent, j);
            parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    }
    std::vector<int> cluster(parent.size(), -1);
    std::unordered_map<int, int> number;
    for (std::size_t i = 0; i < parent.size(); ++i) {
        if (!frame.solid[i]) continue;
        const int root = root_of(parent, static_cast<int>(i));
        cluster[i] = number.try_emplace(root, static_cast<int>(number.size())).first->second;
    }
    return cluster;
}

}  // namespace

void SolidClusters::add_sizes(const std::vector<double>& size) {
    const std::size_t windows = largest_.value.size();
    std::vector<double> counts(sizes_.size(), 0.0);
    double particles = 0;
    double squares = 0;
    for (const double s : size) {
        const auto bin = static_cast<std::size_t>(std::floor(std::log2(s)));
        if (bin >= counts.size()) counts.resize(bin + 1, 0.0);
        counts[bin] += 1;
        particles += s;
        squares += s * s;
    }
    if (counts.size() > sizes_.size()) {  // none of that size before
        sizes_.resize(counts.size(), {std::vector<double>(windows, 0.0)});
    }
    for (std::size_t b = 0; b < counts.size(); ++b) sizes_[b].add(counts[b]);
    largest_.add(size.empty() ? 0 : *std::ranges::max_element(size));
    if (particles > 0) mean_size_.add(squares / particles);
}

void SolidClusters::add(const Frame& frame) {
    const std::vector<int> cluster = clusters_of(frame);
    Window now;
    now.time = frame.time;
    for (std::size_t i = 0; i < cluster.size(); ++i) {
        if (cluster[i] < 0) continue;
        const auto c = static_cast<std::size_t>(cluster[i]);
        if (c >= now.size.size()) now.size.resize(c + 1, 0.0);
        now.size[c] += 1;
        if (follows_ && !frame.id.empty()) now.cluster.emplace(frame.id[i], cluster[i]);
    }
    add_sizes(now.size);
    if (!follows_ || frame.id.empty()) return;
    if (last_) follow(*last_, now);
    if (!first_) first_ = now;
    last_ = std::move(now);
}

// Where the particles of the clusters before went.
void SolidClusters::follow(const Window& before, const Window& now) {
    std::vector<std::unordered_map<int, int>> heirs(before.size.size());
    for (const auto& [id, from] : before.cluster) {
        const auto to = now.cluster.find(id);
        if (to != now.cluster.end()) ++heirs[static_cast<std::size_t>(from)][to->second];
    }
    // The largest first, so that it keeps the name where several merge.
    std::vector<std::size_t> order(before.size.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(
        order, [&](std::size_t a, std::size_t b) { return before.size[a] > before.size[b]; });
    std::vector<bool> taken(now.size.size(), false);
    double trials = 0;
    double deaths = 0;
    for (const std::size_t c : order) {
        if (before.size[c] < static_cast<double>(least)) continue;
        int heir = -1;
        int most = 0;
        for (const auto& [to, count] : heirs[c]) {
            if (count > most || (count == most && to < heir)) {
                heir = to;
                most = count;
            }
        }
        const bool lives =
            heir >= 0 && 2 * most >= before.size[c] && !taken[static_cast<std::size_t>(heir)];
        trials += 1;
        if (lives) taken[static_cast<std::size_t>(heir)] = true;
        if (!lives) deaths += 1;
    }
    at_risk_ += trials * (now.time - before.time);
    trials_.push_back(trials);
    deaths_.push_back(deaths);
}

void SolidClusters::merge(const SolidClusters& later) {
    if (later.largest_.value.empty()) return;
    if (largest_.value.empty()) {
        *this = later;
        return;
    }
    if (last_ && later.first_) follow(*last_, *later.first_);
    if (!first_) first_ = later.first_;
    const std::size_t windows = largest_.value.size();
    const std::size_t bins = std::max(sizes_.size(), later.sizes_.size());
    sizes_.resize(bins, {std::vector<double>(windows, 0.0)});
    const MeanSeries none{std::vector<double>(later.largest_.value.size(), 0.0)};
    for (std::size_t b = 0; b < bins; ++b) {
        sizes_[b].append(b < later.sizes_.size() ? later.sizes_[b] : none);
    }
    largest_.append(later.largest_);
    mean_size_.append(later.mean_size_);
    if (later.last_) last_ = later.last_;
    at_risk_ += later.at_risk_;
    trials_.insert(trials_.end(), later.trials_.begin(), later.trials_.end());
    deaths_.insert(deaths_.end(), later.deaths_.begin(), later.deaths_.end());
}

Measurement SolidClusters::lifetime() const {
    const char* name = "cluster_lifetime";
    const double trials = std::accumulate(trials_.begin(), trials_.end(), 0.0);
    const double deaths = std::accumulate(deaths_.begin(), deaths_.end(), 0.0);
    if (!follows_) {
        return missing(name, "time unit", "every frame is classified alone: no lives to follow");
    }
    if (deaths < 1) {
        return missing(
            name, "time unit",
            trials > 0
                ? fmt::format("no cluster of {} particles died: longer than {:.3g}", least,
                              at_risk_)
                : fmt::format("no cluster of {} particles is followed through two windows", least));
    }
    if (deaths == trials) {
        return missing(name, "time unit",
                       fmt::format("all clusters died within a window: shorter than {:.3g}",
                                   at_risk_ / trials));
    }
    // Seen at the ends of windows Δ only: p = 1 − exp(−Δ/τ).
    const double step = at_risk_ / trials;
    const double death = deaths / trials;
    const double rate = -std::log1p(-death);  // Δ/τ
    Measurement life{name, "time unit", step / rate, std::nullopt, deaths, ""};
    if (deaths < 2) {
        life.reason = "one death: no error";
        return life;
    }
    const double independent = std::sqrt(death * (1 - death) / trials);
    const SeriesError shown = ratio_error(deaths_, trials_);
    const double share_error = std::max(independent, shown.error.value_or(0));
    life.samples *= std::pow(independent / share_error, 2);
    if (shown.is_slow) {
        life.reason = shown.reason;
        return life;
    }
    life.error = step / (rate * rate) * share_error / (1 - death);
    if (!shown.error) life.reason = "deaths taken as independent: " + shown.reason;
    return life;
}

void SolidClusters::add_to(ObservableResult& result) const {
    if (!result.reason.empty() || largest_.value.empty()) return;
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    Curve curve{"clusters",
                "Sizes of the solid clusters",
                {{"size", "-", "Particles in the cluster", {}},
                 {"clusters", "-", "Clusters a window, by size in bins of factor two", {}},
                 {"err", "-", "Standard error", {}},
                 {"samples", "-", "Independent windows", {}}},
                {}};
    for (std::size_t b = 0; b < sizes_.size(); ++b) {
        // The geometric centre of sizes 2^b … 2^(b+1) − 1.
        const double low = std::exp2(static_cast<double>(b));
        const Measurement mean = sizes_[b].measurement("clusters", "-", std::nullopt, "");
        curve.columns[0].values.push_back(std::sqrt(low * (2 * low - 1)));
        curve.columns[1].values.push_back(*mean.value);
        curve.columns[2].values.push_back(mean.error.value_or(undefined));
        curve.columns[3].values.push_back(mean.samples);
    }
    if (!sizes_.empty()) result.curves.push_back(std::move(curve));
    const std::string one = "one window: no error from fluctuations";
    result.measurements.push_back(largest_.measurement("largest_cluster", "-", std::nullopt, one));
    result.measurements.push_back(
        mean_size_.value.empty() ? missing("cluster_size", "-", "no solid particle in any window")
                                 : mean_size_.measurement("cluster_size", "-", std::nullopt, one));
    result.measurements.push_back(lifetime());
}

}  // namespace grainfield::analysis
