#include "simulate/md/md_size.h"

#include <algorithm>

#include "simulate/md/engine/cell_grid.h"
#include "simulate/md/md_series.h"

namespace grainfield::simulate {

namespace {

constexpr double bytes_per_grain = 620;
constexpr double bytes_per_place = 32;  // and its number in a random order
constexpr double events_per_grain_period = 10;
constexpr double events_per_second = 1e6;
constexpr double collisions_to_melt = 100;

}  // namespace

JobSize size_of(const MdOptions& options) {
    const CellOptions& cell = options.cell;
    const double area = cell.length_x * cell.length_y;
    const auto grains = static_cast<double>(cell.grains);
    const double cells = std::min(area * std::max(cell.height, 1.0), CellGrid::most_cells);
    // A layer of low cells has a place for each grain that fits side by side.
    const double places = std::max(area, grains);
    const double rows = options.run.periods / static_cast<double>(options.run.sample_every);
    const auto columns = static_cast<double>(MdSeries(options.system(), cell.grains).columns());
    const double melting = 0.5 * options.initial.melt.value_or(collisions_to_melt);
    JobSize size;
    size.bytes = std::max(places * bytes_per_place + grains * sizeof(Vec3),
                          grains * bytes_per_grain + cells * sizeof(Cell)) +
                 rows * columns * sizeof(double);
    size.seconds =
        grains * (options.run.periods * events_per_grain_period + melting) / events_per_second;
    return size;
}

}  // namespace grainfield::simulate
