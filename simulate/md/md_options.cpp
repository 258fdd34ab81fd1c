#include "simulate/md/md_options.h"

namespace grainfield::simulate {

namespace {

OptionTable describe(CellOptions& o) {
    OptionTable t("cell");
    t.integer("grains", o.grains, "-", {0, 100'000'000}, "number of grains");
    t.number("length-x", o.length_x, "a", {1, 60000}, "length of the cell in x");
    t.number("length-y", o.length_y, "a", {1, 60000}, "length of the cell in y");
    t.number("height", o.height, "a", {1, 60000}, "distance between the plates");
    t.choice("sides-x", o.sides_x, {{"periodic", Side::periodic}, {"walls", Side::walls}},
             "boundaries in x");
    t.choice("sides-y", o.sides_y, {{"periodic", Side::periodic}, {"walls", Side::walls}},
             "boundaries in y");
    t.choice("vertical", o.vertical,
             {{"plates", Vertical::plates}, {"periodic", Vertical::periodic}}, "boundaries in z");
    t.number("gravity", o.gravity, "g", {0, 1e6}, "gravity; 0: none");
    return t;
}

OptionTable describe(VibrationOptions& o) {
    OptionTable t("vibration");
    t.number("amplitude", o.amplitude, "a", {0, 1e3}, "amplitude A of both plates, z = A sin ωt");
    t.number("angular-frequency", o.angular_frequency, "sqrt(g/a)", {0, 1e4},
             "angular frequency ω of the plates");
    return t;
}

OptionTable describe(ContactLaw& o, const char* section, const char* partner) {
    const std::string against = std::string(" against ") + partner;
    OptionTable t(section);
    t.number("restitution", o.restitution, "-", {0, 1}, "normal restitution" + against);
    t.number("tangential-restitution", o.tangential_restitution, "-", {-1, 1},
             "tangential restitution of sticking contacts" + against + "; -1: smooth");
    t.number("static-friction", o.static_friction, "-", {0, 1e9},
             "friction coefficient up to which contacts" + against + " stick; from 1e6 on: always");
    t.number("dynamic-friction", o.dynamic_friction, "-", {0, 1e9},
             "friction coefficient of sliding" + against);
    return t;
}

OptionTable describe(InitialOptions& o) {
    OptionTable t("initial");
    t.choice("layout", o.layout,
             {{"random", InitialLayout::random}, {"square", InitialLayout::square}},
             "disordered, or a square bilayer patch in liquid");
    t.number("temperature", o.temperature, "m g a", {0, 1e9},
             "temperature of the Maxwellian velocities");
    t.number("crystal-spacing", o.crystal_spacing, "a", {0.5, 10},
             "lattice spacing of the patch, in projection");
    t.number("crystal-fraction", o.crystal_fraction, "-", {0, 1},
             "share of the area under the patch");
    t.number("melt", o.melt, "-", {0, 1e6},
             "collisions per grain of elastic mixing; auto: where the start is a lattice");
    return t;
}

OptionTable describe(RunOptions& o) {
    OptionTable t("run");
    t.number("periods", o.periods, "-", {0, 1e9},
             "length of the run in periods 2π/ω; where nothing vibrates, in sqrt(a/g); a resumed "
             "run may end sooner or later");
    t.affects(Effect::extent);
    t.number("discard", o.discard, "-", {0, 1e9}, "periods before the first snapshot");
    t.number("snapshot-every", o.snapshot_every, "-", {1e-3, 1e9}, "periods between snapshots");
    t.number("snapshot-phase", o.snapshot_phase, "-", {0, 1},
             "phase of the vibration at snapshots, in periods");
    t.integer("sample-every", o.sample_every, "-", {1, 1e9},
              "periods between entries of the time series");
    t.number("contact-time", o.contact_time, "sqrt(a/g)", {0, 1e3},
             "TC model: collisions sooner than this after another are elastic; 0: off");
    t.number("plate-tolerance", o.plate_tolerance, "a", {1e-16, 1e-2},
             "gap at which a grain touches a plate");
    t.integer("event-limit", o.event_limit, "-", {100, 4e9},
              "events of one grain in a window that are taken for inelastic collapse");
    t.integer("tiles", o.tiles, "-", {0, 10000},
              "strips of the cell that are simulated at a time; 0: from the threads; same results");
    t.affects(Effect::work);
    return t;
}

}  // namespace

MdSystem MdOptions::system() const {
    MdSystem system;
    system.length = {cell.length_x, cell.length_y, cell.height};
    system.walls_x = cell.sides_x == Side::walls;
    system.walls_y = cell.sides_y == Side::walls;
    system.vertical = cell.vertical;
    system.gravity = cell.gravity;
    system.amplitude = vibration.amplitude;
    system.angular_frequency = vibration.angular_frequency;
    system.grain = grain;
    system.plate = plate;
    system.contact_time = run.contact_time;
    system.plate_tolerance = run.plate_tolerance;
    require_valid(system);
    return system;
}

std::vector<OptionTable> describe(MdOptions& options) {
    return {describe(options.cell),
            describe(options.vibration),
            describe(options.grain, "grain", "grains"),
            describe(options.plate, "plate", "plates and walls"),
            describe(options.initial),
            describe(options.run)};
}

}  // namespace grainfield::simulate
