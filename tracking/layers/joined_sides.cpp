#include "tracking/layers/joined_sides.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <set>
#include <unordered_map>
#include <utility>

namespace grainfield::tracking {
namespace {

struct Candidate {
    double weight;  ///< ln odds for opposite sides
    std::uint32_t first, second;

    /// The surest comes first; ties by number.
    bool operator<(const Candidate& other) const {
        const double mine = std::abs(weight);
        const double its = std::abs(other.weight);
        if (mine != its) return mine < its;
        return std::pair(other.first, other.second) < std::pair(first, second);
    }
};

class SideJoining {
 public:
    SideJoining(std::size_t count, const std::vector<SideLink>& links)
        : weights_(count), members_(count), group_(count), turned_(count, 0) {
        std::iota(group_.begin(), group_.end(), 0U);
        for (std::uint32_t i = 0; i < count; ++i) members_[i] = {i};
        for (const SideLink& link : links) {
            if (link.first == link.second) continue;
            weights_[link.first][link.second] += link.opposite;
            weights_[link.second][link.first] += link.opposite;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            for (const auto& [j, weight] : weights_[i]) {
                if (i < j) candidates_.push({weight, i, j});
            }
        }
    }

    void run(double least) {
        while (!candidates_.empty() && std::abs(candidates_.top().weight) >= least) {
            const Candidate best = candidates_.top();
            candidates_.pop();
            const auto now = weights_[best.first].find(best.second);
            if (now != weights_[best.first].end() && now->second == best.weight) {
                join(best.first, best.second);
            }
        }
    }

    JoinedSides result() && { return {std::move(group_), std::move(turned_)}; }

 private:
    void join(std::uint32_t one, std::uint32_t other) {
        if (members_[one].size() < members_[other].size()) std::swap(one, other);
        const bool turn = weights_[one].at(other) > 0;
        for (const std::uint32_t i : members_[other]) {
            group_[i] = one;
            turned_[i] = static_cast<char>((turned_[i] != 0) != turn);
        }
        members_[one].insert(members_[one].end(), members_[other].begin(), members_[other].end());
        weights_[one].erase(other);
        for (const auto& [k, weight] : weights_[other]) {
            if (k == one) continue;
            weights_[k].erase(other);
            const double sum = weights_[one][k] += turn ? -weight : weight;
            weights_[k][one] = sum;
            candidates_.push({sum, std::min(one, k), std::max(one, k)});
        }
        members_[other] = {};
        weights_[other] = {};
    }

    std::vector<std::unordered_map<std::uint32_t, double>> weights_;  ///< of a group's first member
    std::vector<std::vector<std::uint32_t>> members_;
    std::vector<std::uint32_t> group_;
    std::vector<char> turned_;
    std::priority_queue<Candidate> candidates_;
};

/// Cuts members out of their groups, the weakest first, until the links to the rest of its group
/// support every other one by `least`.
void cut_unsupported(const std::vector<SideLink>& links, double least, JoinedSides& joined) {
    const std::size_t count = joined.group.size();
    struct Support {
        std::uint32_t other;
        double weight;
    };
    std::vector<std::vector<Support>> around(count);
    std::vector<double> support(count, 0);
    for (const SideLink& link : links) {
        if (link.first == link.second) continue;
        if (joined.group[link.first] != joined.group[link.second]) continue;
        const bool opposite = joined.turned[link.first] != joined.turned[link.second];
        const double weight = opposite ? link.opposite : -link.opposite;
        around[link.first].push_back({link.second, weight});
        around[link.second].push_back({link.first, weight});
        support[link.first] += weight;
        support[link.second] += weight;
    }
    std::set<std::pair<double, std::uint32_t>> weak;
    std::vector<char> stays(count, 1);
    for (std::uint32_t i = 0; i < count; ++i) {
        if (support[i] < least) weak.emplace(support[i], i);
    }
    while (!weak.empty()) {
        const std::uint32_t i = weak.begin()->second;
        weak.erase(weak.begin());
        stays[i] = 0;
        for (const auto& [other, weight] : around[i]) {
            if (stays[other] == 0) continue;
            if (support[other] < least) weak.erase({support[other], other});
            support[other] -= weight;
            if (support[other] < least) weak.emplace(support[other], other);
        }
    }
    // What is left of a group may have fallen into parts.
    const JoinedSides before = joined;
    std::vector<char> seen(count, 0);
    for (std::uint32_t first = 0; first < count; ++first) {
        if (seen[first] != 0) continue;
        std::vector<std::uint32_t> part{first};
        seen[first] = 1;
        for (std::size_t k = 0; k < part.size(); ++k) {
            const std::uint32_t i = part[k];
            joined.group[i] = first;
            joined.turned[i] = before.turned[i] != before.turned[first] ? 1 : 0;
            if (stays[i] == 0) continue;
            for (const auto& [other, weight] : around[i]) {
                if (stays[other] == 0 || seen[other] != 0) continue;
                seen[other] = 1;
                part.push_back(other);
            }
        }
    }
}

}  // namespace

JoinedSides join_sides(std::size_t count, const std::vector<SideLink>& links, double least) {
    SideJoining joining(count, links);
    joining.run(least);
    JoinedSides joined = std::move(joining).result();
    cut_unsupported(links, least, joined);
    return joined;
}

}  // namespace grainfield::tracking
