// Time of Q4 for one frame, by number of particles and neighbour rule.

#include <array>
#include <cmath>

#include <benchmark/benchmark.h>

#include "analysis/order/bond_order.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

// A walled layer at the density of the experiment: half crystal with jitter, half random.
Pattern layer(std::int64_t particles) {
    const auto n = static_cast<double>(particles);
    Pattern pattern;
    const double side = std::sqrt(n / 1.17);
    pattern.box = {{0, 0}, {side, side}, {Boundary::walls, Boundary::walls}, 0};
    RandomStream random(1, "layer");
    const double spacing = std::sqrt(1 / 1.17);
    for (double y = spacing / 2; y < side; y += spacing) {
        for (double x = spacing / 2; x < side / 2; x += spacing) {
            pattern.position.push_back({x + 0.03 * random.normal(), y + 0.03 * random.normal()});
        }
    }
    while (static_cast<double>(pattern.size()) < n) {
        pattern.position.push_back(
            {side / 2 + side / 2 * random.uniform(), side * random.uniform()});
    }
    return pattern;
}

void bond_order_time(benchmark::State& state) {
    const Pattern pattern = layer(state.range(0));
    const BondOrderOptions options{.rule = static_cast<NeighbourRule>(state.range(1))};
    for (auto _ : state) benchmark::DoNotOptimize(bond_order(pattern, options));
    state.SetLabel(std::array{"near-four", "near-delaunay", "four-nearest", "delaunay",
                              "fixed-cutoff", "voronoi-edge",
                              "edge-weighted"}[static_cast<std::size_t>(state.range(1))]);
}

BENCHMARK(bond_order_time)
    ->ArgsProduct({{11704, 355500}, {0, 1, 2, 3, 4, 5, 6}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grainfield::analysis
