// A vibrated layer in a periodic cell, and its static structure factor S(k).
#include <cstdio>

#include "analysis/analysis.h"
#include "simulate/simulate.h"

int main() {
    grainfield::simulate::MdOptions layer;
    layer.cell.grains = 400;
    layer.cell.length_x = layer.cell.length_y = 22;  // lengths in a
    layer.run.periods = 40;
    layer.run.discard = 20;
    layer.run.snapshot_every = 2;
    const auto trajectory = grainfield::simulate::simulate_md(layer);

    grainfield::analysis::AnalysisOptions options;
    options.observables = {"sk"};
    const auto results = grainfield::analysis::measure(trajectory, options);
    const auto& curve = *results.find("sk")->find_curve("sk");
    std::printf("%zu snapshots\n", trajectory.snapshots.size());
    for (std::size_t i = 0; i < 5; ++i) {
        std::printf("k %.3f S %.3f\n", curve.find("k")->values[i], curve.find("s")->values[i]);
    }
}
