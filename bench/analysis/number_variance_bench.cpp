// Time of the number variance of one frame: windows of a … 80 a in steps of a, displaced by a/2,
// a/4, a/8, inside a border of 10 a.

#include <benchmark/benchmark.h>

#include "analysis/density/number_variance.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

// Arguments: particles, side [a], windows per a, periodic or not.
void number_variance_time(benchmark::State& state) {
    const auto side = static_cast<double>(state.range(1));
    const Boundary boundary = state.range(3) != 0 ? Boundary::periodic : Boundary::walls;
    Pattern pattern;
    pattern.box = {{0, 0}, {side, side}, {boundary, boundary}, 0};
    RandomStream random(1, "uniform points");
    for (std::int64_t i = 0; i < state.range(0); ++i) {
        pattern.position.push_back({side * random.uniform(), side * random.uniform()});
    }
    const NumberVariance variance({.step = 1 / static_cast<double>(state.range(2))}, pattern.box,
                                  3000);
    for (auto _ : state) benchmark::DoNotOptimize(variance.measure(pattern));
}

BENCHMARK(number_variance_time)
    ->Args({11704, 100, 2, 0})
    ->Args({11704, 100, 4, 0})
    ->Args({11704, 100, 8, 0})
    ->Args({355500, 600, 2, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grainfield::analysis
