// consumer POINTS.csv: prints |Q4| of every particle of the first frame, one a line.
#include <cstdio>

#include "analysis/order/bond_order.h"
#include "core/version.h"
#include "io/text/points_csv.h"
#include "report/report.h"
#include "tracking/tracker.h"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const auto points = grainfield::io::open_points(argv[1], std::nullopt, {});
    const auto order = grainfield::analysis::abs_q4(points->read(0), points->info().diameter, {});
    for (const double q : order) std::printf("%.3f\n", q);

    // Every library links.
    grainfield::tracking::TrackOptions track;
    const auto tables = grainfield::tracking::describe(track);
    const auto labels = &grainfield::report::write_report;
    return tables.empty() || labels == nullptr;
}
