#include "tracking/refine/joint_information.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

constexpr double kWeakest = 1e-4;  // squared coupling below which a pair counts as independent
constexpr double kHidden = 1e-6;   // of the information of an isolated disc
constexpr int kMostSweeps = 200;

struct Pair {
    std::uint32_t i, j;
    CrossBlock block;
};

double trace(const NormalEquations& n) {
    return n.xx + n.yy;
}

double smallest_eigenvalue(const NormalEquations& n) {
    const double half = 0.5 * (n.xx - n.yy);
    return 0.5 * trace(n) - std::sqrt(half * half + n.xy * n.xy);
}

double squared(const CrossBlock& b) {
    return b.xx * b.xx + b.xy * b.xy + b.yx * b.yx + b.yy * b.yy;
}

/// Sums part by part what becomes the information of all.
class Gatherer {
 public:
    explicit Gatherer(const JointFit& fit)
        : fit_(fit),
          // Beyond, edges overlap by less than a thousandth of either's information.
          range_(fit.disc().diameter + 2.5 * fit.disc().edge_width),
          pairs_(static_cast<std::size_t>(fit.scene().parts())) {}

    /// With the positions that all discs have by then; before the first part.
    void prepare(const std::vector<Vec2>& positions) {
        own_.resize(positions.size());
        grid_.emplace(fit_.darkness().width(), fit_.scene().height(), range_);
        for (std::uint32_t i = 0; i < positions.size(); ++i) grid_->add(positions[i], i);
    }

    void gather(int part, std::uint32_t i) {
        thread_local std::vector<std::uint32_t> near;
        own_[i] = fit_.scene().normal_equations(i);
        near.clear();
        grid_->near(fit_.positions()[i], range_, [&](std::uint32_t other, Vec2) {
            if (other > i) near.push_back(other);
        });
        std::sort(near.begin(), near.end());
        std::vector<Pair>& pairs = pairs_[static_cast<std::size_t>(part)];
        for (const std::uint32_t j : near) pairs.push_back({i, j, fit_.scene().coupling(i, j)});
    }

    JointInformation information();

 private:
    const JointFit& fit_;
    double range_;
    std::optional<PointGrid> grid_;
    std::vector<NormalEquations> own_;
    std::vector<std::vector<Pair>> pairs_;
};

JointInformation Gatherer::information() {
    const std::size_t n = own_.size();
    JointInformation info;
    info.own = std::move(own_);
    const double isolated = fit_.disc().information();
    info.is_hidden.reserve(n);
    for (const NormalEquations& own : info.own) {
        info.is_hidden.push_back(!(smallest_eigenvalue(own) > kHidden * isolated));
    }
    std::vector<std::size_t> degree(n, 0);
    const auto is_coupled = [&](const Pair& pair) {
        return !info.is_hidden[pair.i] && !info.is_hidden[pair.j] &&
               4 * squared(pair.block) >
                   kWeakest * trace(info.own[pair.i]) * trace(info.own[pair.j]);
    };
    for (std::vector<Pair>& pairs : pairs_) {
        std::erase_if(pairs, [&](const Pair& pair) { return !is_coupled(pair); });
        for (const Pair& pair : pairs) {
            ++degree[pair.i];
            ++degree[pair.j];
        }
    }
    info.begin.assign(n + 1, 0);
    std::partial_sum(degree.begin(), degree.end(), info.begin.begin() + 1);
    info.entry.resize(info.begin.back());
    auto at = info.begin;
    for (const std::vector<Pair>& pairs : pairs_) {
        for (const Pair& pair : pairs) {
            const CrossBlock& b = pair.block;
            info.entry[at[pair.i]++] = {pair.j, b};
            info.entry[at[pair.j]++] = {pair.i, {b.xx, b.yx, b.xy, b.yy}};
        }
    }
    return info;
}

}  // namespace

JointInformation joint_information(const JointFit& fit) {
    Gatherer gatherer(fit);
    gatherer.prepare(fit.positions());
    fit.in_parts([&](int part, const std::vector<std::uint32_t>& discs) {
        for (std::size_t k = 0; k < discs.size(); ++k) {
            if (k + 1 < discs.size()) fit.scene().fetch(discs[k + 1]);
            gatherer.gather(part, discs[k]);
        }
    });
    return gatherer.information();
}

JointInformation add_all(JointFit& fit, const std::vector<Vec2>& positions,
                         const std::vector<double>& explained, std::optional<double> left) {
    std::vector<Vec2> places;
    places.reserve(positions.size());
    for (const Vec2 p : positions) places.push_back(fit.scene().drawn_place(p));
    Gatherer gatherer(fit);
    gatherer.prepare(places);
    fit.add_all(places, explained, left, [&](int part, const std::vector<std::uint32_t>& discs) {
        for (const std::uint32_t i : discs) gatherer.gather(part, i);
    });
    return gatherer.information();
}

namespace {

/// Σ_j A_ij u_j.
Vec2 times_pending(const JointFit& fit, const JointInformation& info, std::size_t i) {
    const NormalEquations& own = info.own[i];
    const Vec2 u = fit.pending_step(i);
    Vec2 sum{own.xx * u.x + own.xy * u.y, own.xy * u.x + own.yy * u.y};
    for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
        const CrossBlock& b = info.entry[e].block;
        const Vec2 v = fit.pending_step(info.entry[e].other);
        sum += Vec2{b.xx * v.x + b.xy * v.y, b.yx * v.x + b.yy * v.y};
    }
    return sum;
}

}  // namespace

void update_information(const JointFit& fit, const std::vector<char>& disturbed,
                        JointInformation& info) {
    fit.in_parts([&](int, const std::vector<std::uint32_t>& discs) {
        for (const std::uint32_t i : discs) {
            if (disturbed[i]) {
                info.own[i] = fit.scene().normal_equations(i);
                continue;
            }
            const Vec2 b = times_pending(fit, info, i);
            info.own[i].bx = b.x;
            info.own[i].by = b.y;
        }
    });
}

std::vector<double> pending_gain(const JointFit& fit, const JointInformation& info) {
    std::vector<double> gain(info.own.size());
    for (std::size_t i = 0; i < gain.size(); ++i) {
        const Vec2 u = fit.pending_step(i);
        if (squared_norm(u) > 0) gain[i] = dot(u, times_pending(fit, info, i));
    }
    return gain;
}

JointFit::Displacement joint_step(const JointInformation& info, double accuracy) {
    const std::size_t n = info.own.size();
    JointFit::Displacement result{std::vector<Vec2>(n), std::vector<float>(n, 0.0F)};
    std::vector<DampedInverse> inverse;
    inverse.reserve(n);
    for (const NormalEquations& own : info.own) inverse.emplace_back(own);
    std::vector<char> is_awake(n, 1);
    std::vector<char> wakes(n, 0);
    bool any = true;
    for (int sweep = 0; sweep < kMostSweeps && any; ++sweep) {
        any = false;
        for (std::size_t i = 0; i < n; ++i) {
            if (!is_awake[i] || info.is_hidden[i]) continue;
            const NormalEquations& own = info.own[i];
            Vec2 rest{own.bx, own.by};
            for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
                const CrossBlock& b = info.entry[e].block;
                const Vec2 d = result.step[info.entry[e].other];
                rest -= Vec2{b.xx * d.x + b.xy * d.y, b.yx * d.x + b.yy * d.y};
            }
            const Vec2 next = inverse[i] * rest;
            const double change = squared_norm(next - result.step[i]);
            result.step[i] = next;
            result.left[i] = static_cast<float>(change);
            if (!(change > accuracy * accuracy)) continue;
            any = true;
            wakes[i] = 1;
            for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
                wakes[info.entry[e].other] = 1;
            }
        }
        is_awake.swap(wakes);
        std::fill(wakes.begin(), wakes.end(), 0);
    }
    for (float& left : result.left) left = std::sqrt(left);
    return result;
}

}  // namespace grainfield::tracking
