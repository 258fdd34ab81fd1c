// Time of the mean squared displacement: storing the frames and summing all pairs at lags spaced
// logarithmically (8 a decade, up to half the duration).

#include <numeric>

#include <benchmark/benchmark.h>

#include "analysis/motion/displacement.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

// Arguments: particles, frames, threads.
void displacement_time(benchmark::State& state) {
    const auto particles = static_cast<std::size_t>(state.range(0));
    Pattern pattern;
    pattern.box = {{0, 0}, {100, 100}, {Boundary::walls, Boundary::walls}, 0};
    RandomStream random(1, "uniform points");
    for (std::size_t i = 0; i < particles; ++i) {
        pattern.position.push_back({100 * random.uniform(), 100 * random.uniform()});
    }
    pattern.id.resize(particles);
    std::iota(pattern.id.begin(), pattern.id.end(), std::int64_t{0});
    Displacement msd({}, state.range(1), static_cast<int>(state.range(2)));
    for (std::int64_t f = 0; f < state.range(1); ++f) {
        pattern.frame = f;
        pattern.time = static_cast<double>(f);
        pattern.position[static_cast<std::size_t>(f) % particles].x += 0.01;
        msd.add(pattern);
    }
    for (auto _ : state) benchmark::DoNotOptimize(msd.result());
}

BENCHMARK(displacement_time)
    ->Args({11704, 300, 1})
    ->Args({11704, 3000, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

void storing_time(benchmark::State& state) {
    Pattern pattern;
    pattern.box = {{0, 0}, {100, 100}, {Boundary::walls, Boundary::walls}, 0};
    for (std::int64_t i = 0; i < state.range(0); ++i) {
        pattern.position.push_back({0.008 * static_cast<double>(i), 50});
        pattern.id.push_back(i);
    }
    for (auto _ : state) {
        Displacement msd({}, state.range(1));
        for (std::int64_t f = 0; f < state.range(1); ++f) {
            pattern.frame = f;
            msd.add(pattern);
        }
        benchmark::DoNotOptimize(msd);
    }
}

BENCHMARK(storing_time)->Args({11704, 300})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grainfield::analysis
