// Order of points in memory: a square lattice has |Q4| = 1 inside.
#include <cstdio>

#include "analysis/analysis.h"

int main() {
    grainfield::Snapshot points;  // lengths in particle diameters
    points.box = {.origin = {0, 0}, .length = {20, 20}};
    points.box.boundary.fill(grainfield::Boundary::periodic);
    for (int i = 0; i < 400; ++i) {
        const int row = i / 20;
        points.position.push_back({i % 20 + 0.5, row + 0.5});
    }

    grainfield::Trajectory trajectory;
    trajectory.snapshots = {points};
    grainfield::analysis::AnalysisOptions options;
    options.observables = {"q4", "sk"};
    const auto results = grainfield::analysis::measure(trajectory, options);
    for (const double q : results.find("q4")->find_curve("q4_histogram")->find("q4")->values) {
        std::printf("bin of |Q4| at %.2f\n", q);
    }
    const auto& k = results.find("sk")->find_curve("sk")->find("k")->values;
    std::printf("smallest wavevector %.3f /a\n", k.front());
}
