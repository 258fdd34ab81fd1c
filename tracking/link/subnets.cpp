#include "tracking/link/subnets.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace grainfield::tracking {
namespace {

using Pairs = std::vector<AssignmentPair>;

/// Below this share of the largest cost an oversized subnet is no longer cut but taken cheapest
/// first: its spheres stand on one point.
constexpr double kLeastShare = 1e-6;
constexpr double kCut = 0.8;

void keep_largest(std::int64_t& kept, std::size_t value) {
    kept = std::max(kept, static_cast<std::int64_t>(value));
}

/// Union–find over tracks and particles, the smaller index on top.
class Groups {
 public:
    explicit Groups(std::size_t size) : parent_(size) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

 private:
    std::vector<std::uint32_t> parent_;
};

class Chooser {
 public:
    Chooser(std::uint32_t tracks, std::uint32_t particles, double leave, std::int64_t largest,
            SubnetCounts& counts)
        : leave_(leave),
          largest_(static_cast<std::size_t>(std::max<std::int64_t>(1, largest))),
          counts_(counts),
          link_(tracks, -1),
          taken_(particles, 0),
          track_pairs_(tracks, 0),
          particle_pairs_(particles, 0),
          local_(particles, 0) {}

    /// Links what is unambiguous and hands every subnet to `solve`.
    void choose(const Pairs& pairs) {
        for (const AssignmentPair& p : pairs) {
            ++track_pairs_[p.row];
            ++particle_pairs_[p.column];
        }
        Pairs rest;
        for (const AssignmentPair& p : pairs) {
            if (track_pairs_[p.row] == 1 && particle_pairs_[p.column] == 1) {
                link(p.row, p.column);
            } else {
                rest.push_back(p);
            }
        }
        for (const AssignmentPair& p : pairs) track_pairs_[p.row] = particle_pairs_[p.column] = 0;
        for (const Pairs& subnet : split(rest)) solve(subnet);
    }

    std::vector<std::int32_t> links() && { return std::move(link_); }

 private:
    void link(std::uint32_t track, std::uint32_t particle) {
        link_[track] = static_cast<std::int32_t>(particle);
        taken_[particle] = 1;
    }

    /// The connected groups, by their first track; pairs stay sorted by track.
    std::vector<Pairs> split(const Pairs& pairs) const {
        const auto tracks = static_cast<std::uint32_t>(link_.size());
        std::vector<Pairs> subnets;
        if (pairs.empty()) return subnets;
        Groups groups(link_.size() + taken_.size());
        for (const AssignmentPair& p : pairs) groups.join(p.row, tracks + p.column);
        std::vector<std::int32_t> number(link_.size(), -1);  // of the group, at its first track
        for (const AssignmentPair& p : pairs) {
            std::int32_t& n = number[groups.find(p.row)];
            if (n < 0) {
                n = static_cast<std::int32_t>(subnets.size());
                subnets.emplace_back();
            }
            subnets[static_cast<std::size_t>(n)].push_back(p);
        }
        return subnets;
    }

    void solve(const Pairs& subnet) {
        ++counts_.subnets;
        keep_largest(counts_.largest_pairs, subnet.size());
        std::size_t rows = 1;
        for (std::size_t i = 1; i < subnet.size(); ++i) rows += subnet[i].row != subnet[i - 1].row;
        keep_largest(counts_.largest, rows);
        if (subnet.size() <= largest_) {
            assign(subnet);
        } else {
            ++counts_.reduced;
            cut(subnet);
        }
    }

    /// The optimum of one subnet, in indices of its own.
    void assign(const Pairs& subnet) {
        own_pairs_.clear();
        rows_.clear();
        columns_.clear();
        for (const AssignmentPair& p : subnet) {
            if (rows_.empty() || rows_.back() != p.row) rows_.push_back(p.row);
            if (local_[p.column] == 0) {
                columns_.push_back(p.column);
                local_[p.column] = static_cast<std::uint32_t>(columns_.size());
            }
            own_pairs_.push_back(
                {static_cast<std::uint32_t>(rows_.size() - 1), local_[p.column] - 1, p.cost});
        }
        leaves_.assign(rows_.size(), leave_);
        const auto& column =
            solver_.solve(static_cast<std::uint32_t>(rows_.size()),
                          static_cast<std::uint32_t>(columns_.size()), own_pairs_, leaves_);
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            if (column[r] >= 0) link(rows_[r], columns_[static_cast<std::size_t>(column[r])]);
        }
        for (const std::uint32_t c : columns_) local_[c] = 0;
    }

    void cut(const Pairs& subnet) {
        double dearest = 0;
        for (const AssignmentPair& p : subnet) dearest = std::max(dearest, p.cost);
        const double least = kLeastShare * dearest;
        std::vector<Pairs> waiting{subnet};
        for (double limit = kCut * dearest; !waiting.empty() && limit > least; limit *= kCut) {
            std::vector<Pairs> still_too_large;
            for (Pairs& piece : waiting) {
                std::erase_if(piece, [&](const AssignmentPair& p) { return p.cost > limit; });
                for (Pairs& part : split(piece)) {
                    if (part.size() <= largest_) {
                        assign(part);
                    } else {
                        still_too_large.push_back(std::move(part));
                    }
                }
            }
            waiting = std::move(still_too_large);
        }
        take_cheapest_first(subnet);
    }

    void take_cheapest_first(Pairs pairs) {
        std::sort(pairs.begin(), pairs.end(), [](const AssignmentPair& a, const AssignmentPair& b) {
            return std::tie(a.cost, a.row, a.column) < std::tie(b.cost, b.row, b.column);
        });
        for (const AssignmentPair& p : pairs) {
            if (link_[p.row] < 0 && !taken_[p.column]) link(p.row, p.column);
        }
    }

    double leave_;
    std::size_t largest_;
    SubnetCounts& counts_;
    std::vector<std::int32_t> link_;
    std::vector<char> taken_;
    std::vector<std::uint32_t> track_pairs_, particle_pairs_;

    AssignmentSolver solver_;
    Pairs own_pairs_;
    std::vector<std::uint32_t> rows_, columns_, local_;
    std::vector<double> leaves_;
};

}  // namespace

void SubnetCounts::add(const SubnetCounts& other) {
    subnets += other.subnets;
    largest = std::max(largest, other.largest);
    largest_pairs = std::max(largest_pairs, other.largest_pairs);
    reduced += other.reduced;
}

std::vector<std::int32_t> choose_links(const std::vector<AssignmentPair>& pairs,
                                       std::uint32_t tracks, std::uint32_t particles, double leave,
                                       std::int64_t largest, SubnetCounts& counts) {
    Chooser chooser(tracks, particles, leave, largest, counts);
    chooser.choose(pairs);
    return std::move(chooser).links();
}

}  // namespace grainfield::tracking
