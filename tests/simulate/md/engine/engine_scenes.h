#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "core/support/random.h"
#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

inline MdOptions layer(std::int64_t grains, double x, double y) {
    MdOptions o;
    o.cell.grains = grains;
    o.cell.length_x = x;
    o.cell.length_y = y;
    return o;
}

inline GrainState start(const MdOptions& options) {
    GrainState state = make_initial_state(options, 7);
    RandomStream random(3, "spins");
    for (Vec3& w : state.spin) w = {random.normal(), random.normal(), random.normal()};
    return state;
}

inline void run(Engine& engine, GrainState& state, double window, int windows) {
    for (int i = 0; i < windows; ++i) {
        engine.load(state, window);
        engine.advance(window);
        engine.store(window, state);
    }
}

inline bool same_bits(const GrainState& a, const GrainState& b) {
    const auto same = [](const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
        return x.size() == y.size() &&
               std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3)) == 0;
    };
    return same(a.position, b.position) && same(a.velocity, b.velocity) && same(a.spin, b.spin);
}

struct Scene {
    const char* name;
    MdOptions options;
};

inline std::vector<Scene> scenes() {
    std::vector<Scene> all;
    all.push_back({"periodic layer", layer(55, 8, 7.5)});
    MdOptions walls = layer(40, 7, 8.3);
    walls.cell.sides_x = Side::walls;
    walls.cell.sides_y = Side::walls;
    walls.plate.static_friction = 0.4;
    all.push_back({"walled layer", walls});
    all.push_back({"two cells", layer(4, 2.5, 2.2)});
    MdOptions mixed = layer(20, 2.9, 9);
    mixed.cell.sides_y = Side::walls;
    all.push_back({"narrow channel", mixed});
    MdOptions still = layer(50, 8, 8);
    still.vibration.amplitude = 0;
    still.grain.restitution = still.plate.restitution = 1;
    all.push_back({"static plates", still});
    MdOptions tall = layer(60, 5, 5);
    tall.cell.height = 6.5;
    tall.vibration.amplitude = 0.2;
    all.push_back({"tall box", tall});
    MdOptions floating = layer(50, 8, 8);
    floating.cell.gravity = 0;
    floating.vibration.amplitude = 0;
    all.push_back({"no gravity", floating});
    MdOptions gas = layer(60, 4.3, 4.3);
    gas.cell.height = 4.3;
    gas.cell.vertical = Vertical::periodic;
    gas.cell.gravity = 0;
    gas.vibration.amplitude = 0;
    gas.initial.melt = 5;
    all.push_back({"rough gas", gas});
    MdOptions weightless = layer(50, 8, 8);
    weightless.cell.gravity = 0;
    all.push_back({"vibrating plates without gravity", weightless});
    MdOptions sticking = layer(50, 8, 8);
    sticking.grain.static_friction = sticking.grain.dynamic_friction = 1e9;
    sticking.plate = sticking.grain;
    all.push_back({"always sticking", sticking});
    MdOptions tiny = gas;
    tiny.cell.grains = 5;
    tiny.cell.length_x = tiny.cell.length_y = tiny.cell.height = 2.2;
    all.push_back({"box of two diameters", tiny});
    return all;
}

}  // namespace grainfield::simulate
