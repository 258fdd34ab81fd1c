// Time of the density modes of one frame by the non-uniform transform against its error, from a
// tolerance of 1e-3 to 1e-14, and by what `analyze` chooses. The error is the root mean square over
// the modes relative to the direct sum. bench/analysis/run-time-error draws it.

#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include "analysis/spectra/density_transform.h"
#include "bench/analysis/uniform_points.h"

namespace grainfield::analysis {
namespace {

// Arguments: particles, side of the box [a], largest n of the wavevectors dk · n, whether
// dk = 2π/L (2) or π/L (1).
struct Scene {
    explicit Scene(const benchmark::State& state)
        : side(static_cast<double>(state.range(1))),
          points(uniform_points(state.range(0), side)),
          dk(static_cast<double>(state.range(3)) * std::numbers::pi / side),
          grid({dk, dk}, dk * static_cast<double>(state.range(2))) {}
    double side;
    std::vector<Vec2> points;
    double dk;
    ModeGrid grid;
};

void nonuniform_time(benchmark::State& state) {
    const Scene scene(state);
    const NonuniformFourier fourier(scene.grid, std::pow(10, -static_cast<double>(state.range(4))));
    std::vector<std::complex<double>> rho;
    for (auto _ : state) {
        rho = fourier.modes(scene.points, {}, {0, 0}, scene.grid);
        benchmark::DoNotOptimize(rho.data());
    }
    const auto truth = density_modes(scene.points, {0, 0}, scene.grid);
    double squares = 0;
    double norm = 0;
    for (std::size_t m = 0; m < rho.size(); ++m) {
        squares += std::norm(rho[m] - truth[m]);
        norm += std::norm(truth[m]);
    }
    state.counters["error"] = std::sqrt(squares / norm);
    state.counters["modes"] = static_cast<double>(scene.grid.modes().size());
}

void direct_time(benchmark::State& state) {
    const Scene scene(state);
    for (auto _ : state) {
        benchmark::DoNotOptimize(density_modes(scene.points, {0, 0}, scene.grid));
    }
    state.counters["modes"] = static_cast<double>(scene.grid.modes().size());
}

// What `analyze` takes.
void chosen_time(benchmark::State& state) {
    const Scene scene(state);
    const DensityTransform transform(scene.grid);
    for (auto _ : state) {
        benchmark::DoNotOptimize(transform.modes(scene.points, {}, {0, 0}, scene.grid));
    }
    state.counters["modes"] = static_cast<double>(scene.grid.modes().size());
    state.counters["direct"] = transform.is_direct(scene.points.size()) ? 1 : 0;
}

void tolerances(benchmark::internal::Benchmark* bench) {
    for (int digits = 3; digits <= 14; ++digits) {
        bench->Args({11704, 100, 31, 2, digits});  // |k a| ≤ 2
        bench->Args({11704, 100, 63, 1, digits});  // |k a| ≤ 2
        bench->Args({355500, 600, 128, 2, digits});
    }
}

void sizes(benchmark::internal::Benchmark* bench) {
    for (int n : {4, 8, 12, 16, 24, 31, 48, 64}) bench->Args({11704, 100, n, 2});
    bench->Args({11704, 100, 63, 1});
    for (int n : {4, 8, 12, 16, 24, 32}) bench->Args({355500, 600, n, 2});
}

BENCHMARK(nonuniform_time)->Apply(tolerances)->Unit(benchmark::kMillisecond);
BENCHMARK(direct_time)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(chosen_time)->Apply(sizes)->Args({355500, 600, 128, 2})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grainfield::analysis
