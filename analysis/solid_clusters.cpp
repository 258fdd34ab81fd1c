#include "analysis/solid_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

void SolidClusters::add(const Frame& frame) {
    const std::vector<int> cluster = clusters_of(frame);
    std::vector<double> size;
    for (const int c : cluster) {
        if (c < 0) continue;
        if (static_cast<std::size_t>(c) >= size.size())
            size.resize(static_cast<std::size_t>(c) + 1);
        size[static_cast<std::size_t>(c)] += 1;
    }
    double particles = 0;
    double squares = 0;
    for (const double s : size) {
        const auto bin = static_cast<std::size_t>(std::floor(std::log2(s)));
        if (bin >= sizes_.size()) sizes_.resize(bin + 1, 0.0);
        sizes_[bin] += 1;
        particles += s;
        squares += s * s;
    }
    windows_ += 1;
    largest_.add(size.empty() ? 0 : *std::ranges::max_element(size));
    mean_size_.add(particles > 0 ? squares / particles : 0);
    if (!follows_ || frame.id.empty()) return;

    // Where the particles of the clusters before went.
    if (!last_size_.empty()) {
        std::vector<std::unordered_map<int, int>> heirs(last_size_.size());
        for (std::size_t i = 0; i < frame.id.size(); ++i) {
            const auto before = cluster_of_.find(frame.id[i]);
            if (before == cluster_of_.end() || cluster[i] < 0) continue;
            ++heirs[static_cast<std::size_t>(before->second)][cluster[i]];
        }
        // The largest first, so that it keeps the name where several merge.
        std::vector<std::size_t> order(last_size_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(
            order, [&](std::size_t a, std::size_t b) { return last_size_[a] > last_size_[b]; });
        std::vector<bool> taken(size.size(), false);
        for (const std::size_t c : order) {
            if (last_size_[c] < static_cast<double>(least)) continue;
            int heir = -1;
            int most = 0;
            for (const auto& [to, count] : heirs[c]) {
                if (count > most || (count == most && to < heir)) {
                    heir = to;
                    most = count;
                }
            }
            const bool lives =
                heir >= 0 && 2 * most >= last_size_[c] && !taken[static_cast<std::size_t>(heir)];
            at_risk_ += frame.time - last_time_;
            trials_ += 1;
            if (lives) taken[static_cast<std::size_t>(heir)] = true;
            if (!lives) deaths_ += 1;
        }
    }
    cluster_of_.clear();
    for (std::size_t i = 0; i < frame.id.size(); ++i) {
        if (cluster[i] >= 0) cluster_of_.emplace(frame.id[i], cluster[i]);
    }
    last_size_ = size;
    last_time_ = frame.time;
}

void SolidClusters::add_to(ObservableResult& result) const {
    if (!result.reason.empty() || windows_ == 0) return;
    Curve curve{"clusters",
                "Sizes of the solid clusters",
                {{"size", "-", "Particles in the cluster", {}},
                 {"clusters", "-", "Clusters a window, by size in bins of factor two", {}},
                 {"err", "-", "Standard error of counting", {}}},
                {}};
    for (std::size_t b = 0; b < sizes_.size(); ++b) {
        // The geometric centre of sizes 2^b … 2^(b+1) − 1.
        const double low = std::exp2(static_cast<double>(b));
        curve.columns[0].values.push_back(std::sqrt(low * (2 * low - 1)));
        curve.columns[1].values.push_back(sizes_[b] / windows_);
        curve.columns[2].values.push_back(std::sqrt(sizes_[b]) / windows_);
    }
    if (!sizes_.empty()) result.curves.push_back(std::move(curve));
    const std::string one = "one window: no error from fluctuations";
    result.measurements.push_back(largest_.measurement("largest_cluster", "-", std::nullopt, one));
    result.measurements.push_back(mean_size_.measurement("cluster_size", "-", std::nullopt, one));
    const char* name = "cluster_lifetime";
    if (!follows_) {
        result.measurements.push_back(
            missing(name, "time unit", "every frame is classified alone: no lives to follow"));
    } else if (deaths_ < 1) {
        result.measurements.push_back(missing(
            name, "time unit",
            at_risk_ > 0 ? fmt::format("no cluster of {} particles died: longer than {:.3g}", least,
                                       at_risk_)
                         : fmt::format("no cluster of {} particles is followed through two windows",
                                       least)));
    } else if (deaths_ == trials_) {
        result.measurements.push_back(
            missing(name, "time unit",
                    fmt::format("all clusters died within a window: shorter than {:.3g}",
                                at_risk_ / trials_)));
    } else {
        // Seen at the ends of windows Δ only: p = 1 − exp(−Δ/τ).
        const double step = at_risk_ / trials_;
        const double death = deaths_ / trials_;
        const double rate = -std::log1p(-death);  // Δ/τ
        Measurement life{name, "time unit", step / rate, std::nullopt, deaths_, ""};
        if (deaths_ > 1) {
            life.error = step / (rate * rate) * std::sqrt(death / ((1 - death) * trials_));
        } else {
            life.reason = "one death: no error";
        }
        result.measurements.push_back(life);
    }
}

}  // namespace grainfield::analysis
