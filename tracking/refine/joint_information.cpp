#include "tracking/refine/joint_information.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/parallel.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

constexpr double kWeakest = 1e-4;  // squared coupling below which a pair counts as independent
constexpr double kHidden = 1e-6;   // of the information of an isolated disc
constexpr std::size_t kChunk = 256;
constexpr int kMostSweeps = 200;

struct Pair {
    std::uint32_t i, j;
    CrossBlock block;
};

double trace(const NormalEquations& n) {
    return n.xx + n.yy;
}

double smallest_eigenvalue(const NormalEquations& n) {
    return 0.5 * trace(n) - std::hypot(0.5 * (n.xx - n.yy), n.xy);
}

double squared(const CrossBlock& b) {
    return b.xx * b.xx + b.xy * b.xy + b.yx * b.yx + b.yy * b.yy;
}

/// Own blocks and pairs of the discs [first, last).
void gather(const JointFit& fit, const PointGrid& grid, double range, std::size_t first,
            std::size_t last, std::vector<NormalEquations>& own, std::vector<Pair>& pairs) {
    std::vector<std::uint32_t> near;
    for (std::size_t k = first; k < last; ++k) {
        const auto i = static_cast<std::uint32_t>(k);
        if (k + 1 < last) fit.fetch(k + 1);
        own[k] = fit.normal_equations(k);
        near.clear();
        grid.near(fit.positions()[k], range, [&](std::uint32_t other, Vec2) {
            if (other > i) near.push_back(other);
        });
        std::sort(near.begin(), near.end());
        for (const std::uint32_t j : near) pairs.push_back({i, j, fit.coupling(i, j)});
    }
}

}  // namespace

JointInformation joint_information(const JointFit& fit, int threads) {
    const auto& positions = fit.positions();
    const DiscProfile& disc = fit.disc();
    const std::size_t n = positions.size();
    JointInformation info;
    info.own.resize(n);
    // Beyond, edges overlap by less than a thousandth of either's information.
    const double range = disc.diameter + 2.5 * disc.edge_width;
    PointGrid grid(fit.darkness().width(), fit.darkness().height(), range);
    for (std::uint32_t i = 0; i < n; ++i) grid.add(positions[i], i);
    std::vector<std::vector<Pair>> parts((n + kChunk - 1) / kChunk);
    parallel_for(static_cast<std::int64_t>(parts.size()), threads, [&](std::int64_t part) {
        const std::size_t first = static_cast<std::size_t>(part) * kChunk;
        gather(fit, grid, range, first, std::min(n, first + kChunk), info.own,
               parts[static_cast<std::size_t>(part)]);
    });

    const double isolated = std::numbers::pi * disc.diameter / (6 * disc.edge_width);
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
    for (std::vector<Pair>& pairs : parts) {
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
    for (const std::vector<Pair>& pairs : parts) {
        for (const Pair& pair : pairs) {
            const CrossBlock& b = pair.block;
            info.entry[at[pair.i]++] = {pair.j, b};
            info.entry[at[pair.j]++] = {pair.i, {b.xx, b.yx, b.xy, b.yy}};
        }
    }
    return info;
}

void update_information(const JointFit& fit, int threads, const std::vector<char>& disturbed,
                        JointInformation& info) {
    const std::size_t n = info.own.size();
    const auto chunks = static_cast<std::int64_t>((n + kChunk - 1) / kChunk);
    parallel_for(chunks, threads, [&](std::int64_t chunk) {
        const std::size_t first = static_cast<std::size_t>(chunk) * kChunk;
        for (std::size_t i = first; i < std::min(n, first + kChunk); ++i) {
            if (disturbed[i]) {
                info.own[i] = fit.normal_equations(i);
            } else {
                info.own[i].bx = info.own[i].by = 0;
            }
        }
    });
}

JointStep joint_step(const JointInformation& info, double accuracy) {
    const std::size_t n = info.own.size();
    JointStep result{std::vector<Vec2>(n), std::vector<float>(n, 0.0F)};
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
            const Vec2 next = damped_step(own, rest);
            const double change = std::sqrt(squared_norm(next - result.step[i]));
            result.step[i] = next;
            result.left[i] = static_cast<float>(change);
            if (!(change > accuracy)) continue;
            any = true;
            wakes[i] = 1;
            for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
                wakes[info.entry[e].other] = 1;
            }
        }
        is_awake.swap(wakes);
        std::fill(wakes.begin(), wakes.end(), 0);
    }
    return result;
}

}  // namespace grainfield::tracking
