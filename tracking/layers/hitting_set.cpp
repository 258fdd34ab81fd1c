#include "tracking/layers/hitting_set.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace grainfield::tracking {
namespace {

using Members = std::vector<std::uint32_t>;

/// One group: elements renumbered 0 … n − 1.
class Group {
 public:
    Group(std::vector<Members> sets, std::vector<double> weight, std::int64_t budget)
        : sets_(std::move(sets)),
          weight_(std::move(weight)),
          containing_(weight_.size()),
          chosen_(weight_.size(), 0),
          barred_(weight_.size(), 0),
          met_(sets_.size(), 0),
          touched_(weight_.size(), 0),
          budget_(budget) {
        for (std::size_t s = 0; s < sets_.size(); ++s) {
            for (const auto e : sets_[s]) containing_[e].push_back(static_cast<std::uint32_t>(s));
        }
    }

    bool solve() {
        greedy();
        branch(0);
        return budget_ > 0;
    }
    const std::vector<char>& best() const { return best_; }

 private:
    void choose(std::uint32_t e, int step) {
        chosen_[e] = step > 0;
        for (const auto s : containing_[e]) met_[s] += step;
    }

    void greedy() {
        for (;;) {
            std::uint32_t pick = 0;
            double least = std::numeric_limits<double>::infinity();
            for (std::uint32_t e = 0; e < weight_.size(); ++e) {
                const auto gain = std::count_if(containing_[e].begin(), containing_[e].end(),
                                                [this](auto s) { return met_[s] == 0; });
                if (gain == 0) continue;
                const double price = weight_[e] / static_cast<double>(gain);
                if (price < least) {
                    least = price;
                    pick = e;
                }
            }
            if (least == std::numeric_limits<double>::infinity()) break;
            choose(pick, 1);
        }
        drop_superfluous();
        best_ = chosen_;
        best_weight_ = 0;
        for (std::uint32_t e = 0; e < weight_.size(); ++e) {
            if (chosen_[e] == 0) continue;
            best_weight_ += weight_[e];
            choose(e, -1);
        }
    }

    void drop_superfluous() {
        std::vector<std::uint32_t> heaviest(weight_.size());
        std::iota(heaviest.begin(), heaviest.end(), 0U);
        std::stable_sort(heaviest.begin(), heaviest.end(),
                         [this](auto a, auto b) { return weight_[a] > weight_[b]; });
        for (const auto e : heaviest) {
            if (chosen_[e] != 0 && std::all_of(containing_[e].begin(), containing_[e].end(),
                                               [this](auto s) { return met_[s] > 1; })) {
                choose(e, -1);
            }
        }
    }

    /// Weight still needed at least, and the unmet set with the fewest elements left.
    double bound(std::size_t& smallest) {
        std::fill(touched_.begin(), touched_.end(), 0);
        double sum = 0;
        std::size_t fewest = std::numeric_limits<std::size_t>::max();
        for (std::size_t s = 0; s < sets_.size(); ++s) {
            if (met_[s] > 0) continue;
            double lightest = std::numeric_limits<double>::infinity();
            std::size_t left = 0;
            bool disjoint = true;
            for (const auto e : sets_[s]) {
                if (barred_[e] != 0) continue;
                ++left;
                lightest = std::min(lightest, weight_[e]);
                disjoint = disjoint && touched_[e] == 0;
            }
            if (left < fewest) {
                fewest = left;
                smallest = s;
            }
            if (!disjoint) continue;
            sum += lightest;
            for (const auto e : sets_[s]) touched_[e] = 1;
        }
        return sum;
    }

    void branch(double weight) {
        if (--budget_ <= 0) return;
        std::size_t smallest = sets_.size();
        if (weight + bound(smallest) >= best_weight_) return;
        if (smallest == sets_.size()) {
            best_ = chosen_;
            best_weight_ = weight;
            return;
        }
        Members options;
        for (const auto e : sets_[smallest]) {
            if (barred_[e] == 0) options.push_back(e);
        }
        std::stable_sort(options.begin(), options.end(),
                         [this](auto a, auto b) { return weight_[a] < weight_[b]; });
        for (const auto e : options) {
            choose(e, 1);
            branch(weight + weight_[e]);
            choose(e, -1);
            barred_[e] = 1;
        }
        for (const auto e : options) barred_[e] = 0;
    }

    std::vector<Members> sets_;
    std::vector<double> weight_;
    std::vector<Members> containing_;
    std::vector<char> chosen_, barred_;
    std::vector<int> met_;
    std::vector<char> touched_;
    std::int64_t budget_;
    std::vector<char> best_;
    double best_weight_ = 0;
};

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

}  // namespace

HittingSet minimum_hitting_set(const std::vector<std::vector<std::uint32_t>>& sets,
                               const std::vector<double>& weight, std::int64_t budget) {
    HittingSet result;
    if (sets.empty()) return result;
    std::vector<std::uint32_t> parent(weight.size());
    std::iota(parent.begin(), parent.end(), 0U);
    for (const Members& set : sets) {
        for (const auto e : set) parent[find_root(parent, e)] = find_root(parent, set[0]);
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_group;  // (group, set)
    for (std::size_t s = 0; s < sets.size(); ++s) {
        by_group.emplace_back(find_root(parent, sets[s][0]), static_cast<std::uint32_t>(s));
    }
    std::sort(by_group.begin(), by_group.end());

    std::vector<std::uint32_t> local(weight.size());
    for (std::size_t begin = 0; begin < by_group.size();) {
        std::size_t end = begin;
        Members elements;
        for (; end < by_group.size() && by_group[end].first == by_group[begin].first; ++end) {
            const Members& set = sets[by_group[end].second];
            elements.insert(elements.end(), set.begin(), set.end());
        }
        std::sort(elements.begin(), elements.end());
        elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
        std::vector<double> weights;
        for (std::uint32_t e = 0; e < elements.size(); ++e) {
            local[elements[e]] = e;
            weights.push_back(weight[elements[e]]);
        }
        std::vector<Members> own;
        for (std::size_t k = begin; k < end; ++k) {
            Members set = sets[by_group[k].second];
            for (auto& e : set) e = local[e];
            own.push_back(std::move(set));
        }
        Group group(std::move(own), std::move(weights), budget);
        result.exact = group.solve() && result.exact;
        for (std::size_t e = 0; e < elements.size(); ++e) {
            if (group.best()[e] != 0) result.members.push_back(elements[e]);
        }
        begin = end;
    }
    std::sort(result.members.begin(), result.members.end());
    return result;
}

}  // namespace grainfield::tracking
