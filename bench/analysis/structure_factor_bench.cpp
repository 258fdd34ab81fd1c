// Time of the density modes of one frame: |k a| ≤ 2 on both wavevector grids, N = 11,704 in 100 a
// and 355,500 in 600 a, and a square of modes as non-uniform transforms take it.

#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include "analysis/spectra/density_modes.h"
#include "bench/analysis/uniform_points.h"

namespace grainfield::analysis {
namespace {

// Arguments: particles, side of the box [a], largest n of the wavevectors dk · n, and whether
// dk = 2π/L (2) or π/L (1).
void density_modes_time(benchmark::State& state) {
    const auto side = static_cast<double>(state.range(1));
    const std::vector<Vec2> points = uniform_points(state.range(0), side);
    const double dk = static_cast<double>(state.range(3)) * std::numbers::pi / side;
    const ModeGrid grid({dk, dk}, dk * static_cast<double>(state.range(2)));
    for (auto _ : state) benchmark::DoNotOptimize(density_modes(points, {0, 0}, grid));
    state.counters["modes"] = static_cast<double>(grid.modes().size());
}

BENCHMARK(density_modes_time)
    ->Args({11704, 100, 31, 2})  // |k a| ≤ 2
    ->Args({11704, 100, 63, 1})  // |k a| ≤ 2
    ->Args({11704, 100, 16, 2})
    ->Args({11704, 100, 24, 2})
    ->Args({11704, 100, 32, 2})
    ->Args({11704, 100, 64, 2})
    ->Args({355500, 600, 16, 2})
    ->Args({355500, 600, 32, 2})
    ->Args({355500, 600, 64, 2})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grainfield::analysis
