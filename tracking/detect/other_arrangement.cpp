#include "tracking/detect/other_arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>

#include "tracking/detect/residual_blocks.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// Found discs nearer than this are the same sphere: the gate of scores.
constexpr double kSame = 0.25;  // [D]
/// Discs without a partner that share pixels with each other belong together.
constexpr double kTogether = 1.2;  // [D]
/// What a cluster moves: its neighbours and theirs, as in the second look.
constexpr double kZone = 2.5;  // [D]
/// Half a disc and its edge beyond the outermost disc of a cluster, and neighbours at one diameter.
constexpr double kJudged = 1.75;  // [D]
/// Clusters that hold more discs than this are another search, not another arrangement.
constexpr std::size_t kLargest = 40;
constexpr int kRounds = 6;
constexpr int kSweeps = 20;

using Cluster = ArrangementDifference;

void add(Cluster& cluster, Vec2 p) {
    cluster.low = {std::min(cluster.low.x, p.x), std::min(cluster.low.y, p.y)};
    cluster.high = {std::max(cluster.high.x, p.x), std::max(cluster.high.y, p.y)};
}

/// Which of `points` have no partner in `others`, one to one, nearest first.
std::vector<char> alone(const std::vector<Vec2>& points, const std::vector<Vec2>& others, int width,
                        int height, double distance) {
    struct Pair {
        double squared;
        std::uint32_t point, other;
    };
    PointGrid grid(width, height, distance);
    for (std::uint32_t j = 0; j < others.size(); ++j) grid.add(others[j], j);
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        grid.near(points[i], distance, [&](std::uint32_t j, Vec2 p) {
            pairs.push_back({squared_norm(p - points[i]), i, j});
        });
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        return a.squared != b.squared ? a.squared < b.squared
               : a.point != b.point   ? a.point < b.point
                                      : a.other < b.other;
    });
    std::vector<char> is_alone(points.size(), 1);
    std::vector<char> is_taken(others.size(), 0);
    for (const Pair& pair : pairs) {
        if (is_alone[pair.point] == 0 || is_taken[pair.other] != 0) continue;
        is_alone[pair.point] = 0;
        is_taken[pair.other] = 1;
    }
    return is_alone;
}

/// Σ (I − M)² over the box of a cluster, and what lies near it.
double misfit_about(const JointFit& fit, const Cluster& cluster) {
    const double far = kJudged * fit.disc().diameter;
    return misfit_in(fit, cluster.low - Vec2{far, far}, cluster.high + Vec2{far, far});
}

/// Squared distance of a point from the box of a cluster.
double squared_outside(const Cluster& cluster, Vec2 p) {
    const double x = std::max({cluster.low.x - p.x, 0.0, p.x - cluster.high.x});
    const double y = std::max({cluster.low.y - p.y, 0.0, p.y - cluster.high.y});
    return x * x + y * y;
}

/// The boxes of clusters by cells of the frame: a point asks those near it alone.
class ClusterCells {
 public:
    /// For boxes up to `distance` from a point.
    ClusterCells(const std::vector<Cluster>& clusters, double distance, int width, int height,
                 double cell)
        : clusters_(clusters),
          distance_(distance),
          cell_(cell),
          columns_(1 + static_cast<int>(width / cell)),
          rows_(1 + static_cast<int>(height / cell)),
          near_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
        for (std::uint32_t k = 0; k < clusters.size(); ++k) {
            const Cluster& cluster = clusters[k];
            for (int y = row(cluster.low.y - distance); y <= row(cluster.high.y + distance); ++y) {
                for (int x = column(cluster.low.x - distance);
                     x <= column(cluster.high.x + distance); ++x) {
                    near_[index(x, y)].push_back(k);
                }
            }
        }
    }

    /// Whether judge(cluster) holds for any of those whose box is nearer to p than the distance.
    template <class Judge>
    bool any_near(Vec2 p, Judge&& judge) const {
        const std::vector<std::uint32_t>& here = near_[index(column(p.x), row(p.y))];
        return std::any_of(here.begin(), here.end(), [&](std::uint32_t k) {
            return squared_outside(clusters_[k], p) < distance_ * distance_ && judge(clusters_[k]);
        });
    }

 private:
    int clamped(double value, int count) const {
        const double cells = value / cell_;
        if (!(cells > 0)) return 0;
        return cells < count ? static_cast<int>(cells) : count - 1;
    }
    int column(double x) const { return clamped(x, columns_); }
    int row(double y) const { return clamped(y, rows_); }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(x);
    }

    const std::vector<Cluster>& clusters_;
    double distance_, cell_;
    int columns_, rows_;
    std::vector<std::vector<std::uint32_t>> near_;
};

bool are_apart(const Cluster& a, const Cluster& b, double distance) {
    const double x = std::max({a.low.x - b.high.x, b.low.x - a.high.x, 0.0});
    const double y = std::max({a.low.y - b.high.y, b.low.y - a.high.y, 0.0});
    return x * x + y * y > distance * distance;
}

/// Removes discs for which gone(j) holds, and adds others.
template <class Gone>
void exchange(JointFit& fit, const std::vector<Vec2>& added, Gone&& gone) {
    std::vector<char> keep(fit.positions().size(), 1);
    for (std::size_t j = 0; j < keep.size(); ++j) keep[j] = gone(fit.positions()[j]) ? 0 : 1;
    fit.keep_only(keep);
    for (const Vec2 p : added) fit.add(p);
}

}  // namespace

OtherArrangement compare_arrangements(const std::vector<Vec2>& ours,
                                      const std::vector<Vec2>& theirs, double diameter, int width,
                                      int height) {
    const std::vector<char> we_alone = alone(ours, theirs, width, height, kSame * diameter);
    const std::vector<char> they_alone = alone(theirs, ours, width, height, kSame * diameter);
    std::vector<std::pair<Vec2, bool>> loose;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        if (we_alone[i] != 0) loose.emplace_back(ours[i], true);
    }
    for (std::size_t j = 0; j < theirs.size(); ++j) {
        if (they_alone[j] != 0) loose.emplace_back(theirs[j], false);
    }
    PointGrid grid(width, height, kTogether * diameter);
    for (std::uint32_t i = 0; i < loose.size(); ++i) grid.add(loose[i].first, i);
    std::vector<char> is_done(loose.size(), 0);
    OtherArrangement other;
    for (std::uint32_t first = 0; first < loose.size(); ++first) {
        if (is_done[first] != 0) continue;
        Cluster cluster{{}, {}, loose[first].first, loose[first].first, 0};
        std::vector<std::uint32_t> open{first};
        is_done[first] = 1;
        while (!open.empty()) {
            const std::uint32_t i = open.back();
            open.pop_back();
            const auto& [p, is_ours] = loose[i];
            (is_ours ? cluster.ours : cluster.theirs).push_back(p);
            add(cluster, p);
            grid.near(p, kTogether * diameter, [&](std::uint32_t j, Vec2) {
                if (is_done[j] != 0) return;
                is_done[j] = 1;
                open.push_back(j);
            });
        }
        // With nothing in exchange it is a search for false discs, which has been made.
        if (cluster.theirs.empty()) continue;
        const std::size_t size = cluster.ours.size() + cluster.theirs.size();
        other.unlike += size;
        if (size > kLargest) {
            other.unlike_in_large += size;
        } else {
            other.differences.push_back(std::move(cluster));
        }
    }
    return other;
}

std::int64_t try_differences(JointFit& fit, std::vector<ArrangementDifference>& differences,
                             bool reversed, const RefinementOptions& refinement) {
    const double diameter = fit.disc().diameter;
    fit.draw_pending();
    RefinementOptions few = refinement;
    few.max_sweeps = std::min(refinement.max_sweeps, kSweeps);
    // What moves by itself must not count for a trial.
    std::int64_t steps = fit.refine(few).steps;
    std::vector<std::size_t> waiting(differences.size());
    std::iota(waiting.begin(), waiting.end(), std::size_t{0});
    for (int round = 0; round < kRounds && !waiting.empty(); ++round) {
        std::vector<std::size_t> tried;
        std::vector<std::size_t> later;
        for (const std::size_t k : waiting) {
            const bool is_near = std::any_of(tried.begin(), tried.end(), [&](std::size_t t) {
                return !are_apart(differences[t], differences[k], 2 * kZone * diameter);
            });
            (is_near ? later : tried).push_back(k);
        }
        waiting = std::move(later);
        const std::vector<Vec2> positions = fit.positions();
        std::vector<Cluster> now;
        std::vector<double> before;
        for (const std::size_t k : tried) {
            now.push_back(differences[k]);
            if (reversed) std::swap(now.back().ours, now.back().theirs);
            before.push_back(misfit_about(fit, differences[k]));
        }
        steps += take_differences(fit, now, few);
        for (std::size_t t = 0; t < tried.size(); ++t) {
            differences[tried[t]].change = misfit_about(fit, now[t]) - before[t];
        }
        const ClusterCells cells(now, kZone * diameter, fit.darkness().width(),
                                 fit.darkness().height(), kZone * diameter);
        const auto is_undone = [&](Vec2 p) {
            return cells.any_near(p, [](const Cluster&) { return true; });
        };
        std::vector<Vec2> back;
        std::copy_if(positions.begin(), positions.end(), std::back_inserter(back), is_undone);
        exchange(fit, back, is_undone);
        steps += fit.refine(few).steps;
    }
    return steps;
}

std::int64_t take_differences(JointFit& fit, const std::vector<ArrangementDifference>& differences,
                              const RefinementOptions& refinement) {
    const double same = 0.5 * kSame * fit.disc().diameter;
    std::vector<Vec2> added;
    for (const Cluster& cluster : differences) {
        added.insert(added.end(), cluster.theirs.begin(), cluster.theirs.end());
    }
    const ClusterCells cells(differences, same, fit.darkness().width(), fit.darkness().height(),
                             kZone * fit.disc().diameter);
    exchange(fit, added, [&](Vec2 p) {
        return cells.any_near(p, [&](const Cluster& cluster) {
            return std::any_of(cluster.ours.begin(), cluster.ours.end(),
                               [&](Vec2 q) { return squared_norm(p - q) < same * same; });
        });
    });
    return fit.refine(refinement).steps;
}

}  // namespace grainfield::tracking
