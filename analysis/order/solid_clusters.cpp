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

// The numbers of the windows that count and have one.
MeanSeries of_counted(const MeanSeries& series, const std::vector<bool>& counted) {
    MeanSeries kept;
    for (std::size_t w = 0; w < counted.size(); ++w) {
        if (counted[w] && std::isfinite(series.value[w])) kept.add(series.value[w]);
    }
    return kept;
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
    mean_size_.add(particles > 0 ? squares / particles : std::numeric_limits<double>::quiet_NaN());
}

void SolidClusters::add(const Frame& frame) {
    const std::vector<int> cluster = clusters_of(frame);
    Window now;
    now.time = frame.time;
    now.number = frames_.size();
    frames_.push_back(frame.frames);
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
    Step step{before.number, now.number, 0, 0, now.time - before.time};
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
        step.trials += 1;
        if (lives) taken[static_cast<std::size_t>(heir)] = true;
        if (!lives) step.deaths += 1;
    }
    steps_.push_back(step);
}

void SolidClusters::merge(const SolidClusters& later) {
    if (later.largest_.value.empty()) return;
    if (largest_.value.empty()) {
        *this = later;
        return;
    }
    const std::size_t windows = frames_.size();
    const auto moved = [&](std::optional<Window> window) {
        if (window) window->number += windows;
        return window;
    };
    const std::optional<Window> next = moved(later.first_);
    if (last_ && next) follow(*last_, *next);
    if (!first_) first_ = next;
    const std::size_t bins = std::max(sizes_.size(), later.sizes_.size());
    sizes_.resize(bins, {std::vector<double>(windows, 0.0)});
    const MeanSeries none{std::vector<double>(later.largest_.value.size(), 0.0)};
    for (std::size_t b = 0; b < bins; ++b) {
        sizes_[b].append(b < later.sizes_.size() ? later.sizes_[b] : none);
    }
    largest_.append(later.largest_);
    mean_size_.append(later.mean_size_);
    frames_.insert(frames_.end(), later.frames_.begin(), later.frames_.end());
    if (later.last_) last_ = moved(later.last_);
    for (Step step : later.steps_) {
        step.from += windows;
        step.to += windows;
        steps_.push_back(step);
    }
}

std::vector<bool> SolidClusters::counted(const WindowRule& rule) const {
    std::vector<bool> counted;
    for (const double frames : frames_) counted.push_back(!rule.is_short(frames));
    return counted;
}

Measurement SolidClusters::lifetime(const std::vector<bool>& counted) const {
    const char* name = "cluster_lifetime";
    std::vector<double> all_trials, all_deaths;
    double at_risk = 0;  // time
    for (const Step& step : steps_) {
        if (!counted[step.from] || !counted[step.to]) continue;
        all_trials.push_back(step.trials);
        all_deaths.push_back(step.deaths);
        at_risk += step.trials * step.time;
    }
    const double trials = std::accumulate(all_trials.begin(), all_trials.end(), 0.0);
    const double deaths = std::accumulate(all_deaths.begin(), all_deaths.end(), 0.0);
    if (!follows_) {
        return missing(name, "time unit", "every frame is classified alone: no lives to follow");
    }
    if (deaths < 1) {
        return missing(
            name, "time unit",
            trials > 0
                ? fmt::format("no cluster of {} particles died: longer than {:.3g}", least, at_risk)
                : fmt::format("no cluster of {} particles is followed through two windows", least));
    }
    if (deaths == trials) {
        return missing(name, "time unit",
                       fmt::format("all clusters died within a window: shorter than {:.3g}",
                                   at_risk / trials));
    }
    // Seen at the ends of windows Δ only: p = 1 − exp(−Δ/τ).
    const double step = at_risk / trials;
    const double death = deaths / trials;
    const double rate = -std::log1p(-death);  // Δ/τ
    Measurement life{name, "time unit", step / rate, std::nullopt, deaths, ""};
    if (deaths < 2) {
        life.reason = "one death: no error";
        return life;
    }
    const double independent = std::sqrt(death * (1 - death) / trials);
    const SeriesError shown = ratio_error(all_deaths, all_trials);
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

void SolidClusters::add_to(ObservableResult& result, const WindowRule& rule) const {
    if (!result.reason.empty() || largest_.value.empty()) return;
    const std::vector<bool> counted = this->counted(rule);
    const MeanSeries largest = of_counted(largest_, counted);
    const MeanSeries mean_size = of_counted(mean_size_, counted);
    if (largest.value.empty()) {
        const char* why = "no window with particles holds enough frames";
        result.measurements.push_back(missing("largest_cluster", "-", why));
        result.measurements.push_back(missing("cluster_size", "-", why));
        result.measurements.push_back(missing("cluster_lifetime", "time unit", why));
        return;
    }
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    Curve curve{"clusters",
                "Sizes of the solid clusters",
                {{"size", "-", "Particles in the cluster", {}},
                 {"clusters", "-", "Clusters a window, by size in bins of factor two", {}},
                 {"err", "-", "Standard error", {}},
                 {"samples", "-", "Independent windows", {}}},
                {}};
    std::size_t bins = sizes_.size();
    const auto is_seen = [](double clusters) { return clusters > 0; };
    while (bins > 0 && std::ranges::none_of(of_counted(sizes_[bins - 1], counted).value, is_seen)) {
        --bins;  // in short windows only
    }
    for (std::size_t b = 0; b < bins; ++b) {
        // The geometric centre of sizes 2^b … 2^(b+1) − 1.
        const double low = std::exp2(static_cast<double>(b));
        const Measurement mean =
            of_counted(sizes_[b], counted).measurement("clusters", "-", std::nullopt, "");
        curve.columns[0].values.push_back(std::sqrt(low * (2 * low - 1)));
        curve.columns[1].values.push_back(*mean.value);
        curve.columns[2].values.push_back(mean.error.value_or(undefined));
        curve.columns[3].values.push_back(mean.samples);
    }
    if (!curve.columns[0].values.empty()) result.curves.push_back(std::move(curve));
    const std::string one = "one window: no error from fluctuations";
    result.measurements.push_back(largest.measurement("largest_cluster", "-", std::nullopt, one));
    result.measurements.push_back(
        mean_size.value.empty() ? missing("cluster_size", "-", "no solid particle in any window")
                                : mean_size.measurement("cluster_size", "-", std::nullopt, one));
    result.measurements.push_back(lifetime(counted));
}

}  // namespace grainfield::analysis
