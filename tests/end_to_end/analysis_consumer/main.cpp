// Prints |Q4| in the middle of a square lattice of 5 × 5 points.
#include <cstdio>

#include "analysis/order/bond_order.h"

int main() {
    grainfield::Snapshot snapshot;
    snapshot.box.length = {5, 5};
    for (int i = 0; i < 25; ++i) snapshot.position.push_back({i % 5 + 0.5, i / 5 + 0.5});
    std::printf("%.3f\n", grainfield::analysis::abs_q4(snapshot, 1, {})[12]);
}
