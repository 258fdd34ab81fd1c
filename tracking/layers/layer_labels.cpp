#include "tracking/layers/layer_labels.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/layers/joined_sides.h"

namespace grainfield::tracking {
namespace {

constexpr double kTolerance = 1e-9;  // of a height [a]
constexpr std::size_t kLargestSearch = 2000;
constexpr int kMostRounds = 10;
constexpr double kLeastLogOdds = 4.6;  // 100 to 1

class SideInference {
 public:
    SideInference(const OverlapGraph& graph, const std::vector<char>& kept)
        : graph_(graph),
          kept_(kept),
          parent_(graph.size()),
          opposite_(graph.size(), 0),
          members_(graph.size()),
          low_(graph.size(), graph.slack() / 2),
          high_(graph.size(), graph.slack()),
          doubtful_(graph.size(), 0),
          forced_(graph.pairs().size(), 0),
          contradicts_(graph.pairs().size(), 0),
          queued_(graph.pairs().size(), 0) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }

    void run() {
        std::vector<std::uint32_t> first;
        for (std::uint32_t e = 0; e < graph_.pairs().size(); ++e) {
            // Weaker overlaps say nothing until their spheres are bound.
            if (graph_.pairs()[e].sure_rise > graph_.slack() / 2) first.push_back(e);
        }
        // The surest first: where two contradict each other, the weaker one is not believed.
        std::stable_sort(first.begin(), first.end(), [this](auto a, auto b) {
            return graph_.pairs()[a].sure_rise > graph_.pairs()[b].sure_rise;
        });
        for (const std::uint32_t e : first) enqueue(e);
        for (std::size_t k = 0; k < queue_.size(); ++k) {
            queued_[queue_[k]] = 0;
            apply(queue_[k]);
        }
        for (std::uint32_t e = 0; e < contradicts_.size(); ++e) {
            if (contradicts_[e] != 0) doubt_ring(e);
        }
    }

    /// Spheres of rings that contradict themselves.
    const std::vector<char>& doubtful() const { return doubtful_; }
    bool is_consistent() const {
        return std::find(doubtful_.begin(), doubtful_.end(), 1) == doubtful_.end();
    }

    /// Root, and whether i lies on the other side of it. Unions by size keep the paths short.
    std::pair<std::uint32_t, bool> side(std::uint32_t i) const {
        bool other = false;
        for (; parent_[i] != i; i = parent_[i]) other ^= opposite_[i] != 0;
        return {i, other};
    }

    double low(std::uint32_t i) const { return low_[i]; }  ///< of w [a]
    double high(std::uint32_t i) const { return high_[i]; }

 private:
    void enqueue(std::uint32_t e) {
        const OverlapPair& pair = graph_.pairs()[e];
        if (queued_[e] != 0 || pair.sure_rise <= 0 || kept_[pair.first] == 0 ||
            kept_[pair.second] == 0) {
            return;
        }
        queued_[e] = 1;
        queue_.push_back(e);
    }
    void enqueue_around(std::uint32_t i) {
        for (const auto link : graph_.links(i)) enqueue(link.pair);
    }

    void apply(std::uint32_t e) {
        const OverlapPair& pair = graph_.pairs()[e];
        const std::uint32_t i = pair.first;
        const std::uint32_t j = pair.second;
        const double rise = pair.sure_rise;
        const double slack = graph_.slack();
        auto [root_i, other_i] = side(i);
        auto [root_j, other_j] = side(j);
        const bool i_may_be_higher = high_[i] >= low_[j] + rise - kTolerance;
        const bool j_may_be_higher = high_[j] >= low_[i] + rise - kTolerance;
        const bool may_be_alike = i_may_be_higher || j_may_be_higher;
        const bool may_be_opposite = high_[i] + high_[j] >= slack + rise - kTolerance;
        if (!may_be_alike && !may_be_opposite) {
            contradicts_[e] = 1;
            return;
        }
        if (may_be_alike != may_be_opposite) forced_[e] = 1;
        if (root_i != root_j) {
            if (forced_[e] == 0) return;
            join(root_i, root_j, (other_i != other_j) != may_be_opposite);
            other_j = other_i != may_be_opposite;
        }
        const bool opposite = other_i != other_j;
        if (opposite ? !may_be_opposite : !may_be_alike) {
            contradicts_[e] = 1;
        } else if (opposite) {
            raise(i, slack + rise - high_[j]);
            raise(j, slack + rise - high_[i]);
        } else if (!j_may_be_higher) {
            raise(i, low_[j] + rise);
            lower(j, high_[i] - rise);
        } else if (!i_may_be_higher) {
            raise(j, low_[i] + rise);
            lower(i, high_[j] - rise);
        }
    }

    /// One of the spheres of the shortest ring that a contradiction closes is misplaced; which
    /// one is not known.
    void doubt_ring(std::uint32_t e) {
        const std::uint32_t start = graph_.pairs()[e].first;
        const std::uint32_t goal = graph_.pairs()[e].second;
        doubtful_[start] = doubtful_[goal] = 1;
        std::unordered_map<std::uint32_t, std::uint32_t> before{{start, start}};
        std::vector<std::uint32_t> reached{start};
        for (std::size_t k = 0; k < reached.size() && reached.size() < kLargestSearch; ++k) {
            for (const auto link : graph_.links(reached[k])) {
                if (forced_[link.pair] == 0 || contradicts_[link.pair] != 0) continue;
                if (!before.emplace(link.sphere, reached[k]).second) continue;
                reached.push_back(link.sphere);
                if (link.sphere != goal) continue;
                for (std::uint32_t i = goal; i != start; i = before[i]) doubtful_[i] = 1;
                return;
            }
        }
    }

    void join(std::uint32_t one, std::uint32_t other, bool opposite) {
        if (members_[one].size() < members_[other].size()) std::swap(one, other);
        parent_[other] = one;
        opposite_[other] = opposite ? 1 : 0;
        auto& joined = members_[one];
        joined.push_back(other);
        joined.insert(joined.end(), members_[other].begin(), members_[other].end());
        enqueue_around(other);
        for (const auto i : members_[other]) enqueue_around(i);
        members_[other] = {};
    }

    // A bound beyond the other one is not believed, and its sphere not named.
    void raise(std::uint32_t i, double value) {
        if (value <= low_[i] + 1e-12) return;
        if (value > high_[i] + kTolerance) {
            doubtful_[i] = 1;
            return;
        }
        low_[i] = value;
        enqueue_around(i);
    }
    void lower(std::uint32_t i, double value) {
        if (value >= high_[i] - 1e-12) return;
        if (value < low_[i] - kTolerance) {
            doubtful_[i] = 1;
            return;
        }
        high_[i] = value;
        enqueue_around(i);
    }

    const OverlapGraph& graph_;
    const std::vector<char>& kept_;
    std::vector<std::uint32_t> parent_;
    std::vector<char> opposite_;                       ///< to the parent
    std::vector<std::vector<std::uint32_t>> members_;  ///< of a root, itself left out
    std::vector<double> low_, high_;                   ///< of w [a]
    std::vector<char> doubtful_;                       ///< spheres
    std::vector<char> forced_, contradicts_, queued_;  ///< pairs
    std::vector<std::uint32_t> queue_;
};

/// Which side each sphere is on, up to turning all of a group.
struct Sides {
    std::vector<std::uint32_t> group;
    std::vector<char> turned;
};

bool is_overlap(const OverlapPair& pair, const std::vector<char>& believed) {
    return believed[pair.first] != 0 && believed[pair.second] != 0 && pair.distance < 1;
}

/// Groups that are forced, and those joined by the odds of the overlaps between them.
Sides joined_groups(const OverlapGraph& graph, const SideInference& inference,
                    const std::vector<char>& believed) {
    const std::size_t n = graph.size();
    std::vector<std::uint32_t> root(n);
    std::vector<char> other(n);
    for (std::uint32_t i = 0; i < n; ++i) std::tie(root[i], other[i]) = inference.side(i);
    std::vector<SideLink> links;
    for (const OverlapPair& pair : graph.pairs()) {
        const std::uint32_t i = pair.first;
        const std::uint32_t j = pair.second;
        if (root[i] == root[j] || !is_overlap(pair, believed)) continue;
        const double odds = opposite_log_odds(pair.distance, pair.distance_error, graph.slack());
        links.push_back({root[i], root[j], other[i] == other[j] ? odds : -odds});
    }
    const JoinedSides joined = join_sides(n, links, kLeastLogOdds);
    Sides sides{std::vector<std::uint32_t>(n), std::vector<char>(n)};
    for (std::size_t i = 0; i < n; ++i) {
        sides.group[i] = joined.group[root[i]];
        sides.turned[i] = other[i] != joined.turned[root[i]] ? 1 : 0;
    }
    return sides;
}

/// The members of the groups that are named: the largest first, each that overlaps no group named
/// before it, as no overlap tells how it is turned against that one.
std::vector<std::vector<std::uint32_t>> named_groups(const OverlapGraph& graph, const Sides& sides,
                                                     const std::vector<char>& believed) {
    const std::size_t n = graph.size();
    std::vector<std::vector<std::uint32_t>> members(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        if (believed[i] != 0) members[sides.group[i]].push_back(i);
    }
    std::vector<std::vector<std::uint32_t>> touching(n);  // groups
    for (const OverlapPair& pair : graph.pairs()) {
        const std::uint32_t one = sides.group[pair.first];
        const std::uint32_t other = sides.group[pair.second];
        if (one == other || !is_overlap(pair, believed)) continue;
        touching[one].push_back(other);
        touching[other].push_back(one);
    }
    std::vector<std::uint32_t> by_size;
    for (std::uint32_t g = 0; g < n; ++g) {
        if (members[g].size() > 1) by_size.push_back(g);
    }
    std::ranges::stable_sort(by_size, std::greater{},
                             [&](std::uint32_t g) { return members[g].size(); });
    std::vector<std::vector<std::uint32_t>> named;
    std::vector<char> is_named(n, 0);
    for (const std::uint32_t g : by_size) {
        const bool touches = std::ranges::any_of(
            touching[g], [&](std::uint32_t other) { return is_named[other] != 0; });
        if (touches) continue;
        is_named[g] = 1;
        named.push_back(std::move(members[g]));
    }
    return named;
}

LayerLabels labels_of(const OverlapGraph& graph, const SideInference& inference,
                      const std::vector<char>& believed) {
    const std::size_t n = graph.size();
    const double slack = graph.slack();
    LayerLabels result;
    result.slack = slack;
    result.layer.assign(n, Layer::unknown);
    result.cluster.assign(n, -1);
    result.lowest.assign(n, 0);
    result.highest.assign(n, slack);
    const Sides sides = joined_groups(graph, inference, believed);
    for (const auto& members : named_groups(graph, sides, believed)) {
        const auto turned = static_cast<std::size_t>(
            std::ranges::count_if(members, [&](std::uint32_t i) { return sides.turned[i] != 0; }));
        const bool bottom_is_turned = 2 * turned == members.size()
                                          ? sides.turned[members.front()] != 0
                                          : 2 * turned > members.size();
        for (const std::uint32_t i : members) {
            const bool bottom = (sides.turned[i] != 0) == bottom_is_turned;
            result.cluster[i] = result.clusters;
            result.layer[i] = bottom ? Layer::bottom : Layer::top;
            result.lowest[i] = bottom ? slack - inference.high(i) : inference.low(i);
            result.highest[i] = bottom ? slack - inference.low(i) : inference.high(i);
        }
        ++result.clusters;
    }
    return result;
}

}  // namespace

LayerLabels label_layers(const OverlapGraph& graph, const std::vector<char>& kept) {
    if (kept.size() != graph.size()) {
        throw InputError(ErrorText{"spheres and their marks differ in number",
                                   fmt::format("{} marks", kept.size()),
                                   fmt::format("{}", graph.size()), ""});
    }
    // Without the spheres that contradict each other the rest may be consistent.
    std::vector<char> believed = kept;
    std::int64_t contradictory = 0;
    for (int round = 1;; ++round) {
        SideInference inference(graph, believed);
        inference.run();
        for (std::size_t i = 0; i < believed.size(); ++i) {
            if (inference.doubtful()[i] == 0) continue;
            believed[i] = 0;
            ++contradictory;
        }
        if (inference.is_consistent() || round == kMostRounds) {
            LayerLabels labels = labels_of(graph, inference, believed);
            labels.contradictory = contradictory;
            return labels;
        }
    }
}

void keep_sides(LayerLabels& labels, const std::vector<Layer>& earlier) {
    if (earlier.size() != labels.layer.size()) {
        throw InputError(ErrorText{"spheres and their earlier layers differ in number",
                                   fmt::format("{} layers", earlier.size()),
                                   fmt::format("{}", labels.layer.size()), ""});
    }
    std::vector<std::int64_t> agreement(static_cast<std::size_t>(labels.clusters), 0);
    for (std::size_t i = 0; i < earlier.size(); ++i) {
        if (labels.cluster[i] < 0 || earlier[i] == Layer::unknown) continue;
        agreement[static_cast<std::size_t>(labels.cluster[i])] +=
            earlier[i] == labels.layer[i] ? 1 : -1;
    }
    for (std::size_t i = 0; i < earlier.size(); ++i) {
        if (labels.cluster[i] < 0 || agreement[static_cast<std::size_t>(labels.cluster[i])] >= 0) {
            continue;
        }
        labels.layer[i] = labels.layer[i] == Layer::top ? Layer::bottom : Layer::top;
        const double lowest = labels.lowest[i];
        labels.lowest[i] = labels.slack - labels.highest[i];
        labels.highest[i] = labels.slack - lowest;
    }
}

}  // namespace grainfield::tracking
