// Frames of a simulated layer, tracked, and how many true spheres are found.
#include <algorithm>
#include <cstdio>

#include "simulate/simulate.h"
#include "tracking/tracking.h"

int main() {
    grainfield::simulate::MdOptions layer;
    layer.cell.grains = 150;
    layer.cell.length_x = layer.cell.length_y = 20;
    layer.run.periods = 2;
    layer.run.snapshot_every = 1;
    grainfield::simulate::RenderOptions camera;
    camera.view.width = camera.view.height = 400;
    const auto film =
        grainfield::simulate::render(grainfield::simulate::simulate_md(layer), camera);

    const auto& truth = film.truth.snapshots.front().position;
    const auto found = grainfield::tracking::locate(film.frames.front().image).position;
    const auto close = [&](auto p) {
        return std::ranges::any_of(found, [p](auto f) { return norm(f - p) < 3; });
    };
    std::printf("found %td of %zu spheres\n", std::ranges::count_if(truth, close), truth.size());
}
