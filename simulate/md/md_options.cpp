#include "simulate/md/md_options.h"

#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::simulate {

namespace {

constexpr Range kAmplitudes{0, 1e3};          // [a]
constexpr Range kAngularFrequencies{0, 1e4};  // [sqrt(g/a)]

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
    t.number("amplitude", o.amplitude, "a", kAmplitudes,
             "amplitude A of both plates, z = A sin ωt; auto: from gamma or amplitude-mm, or 0.08");
    t.number("angular-frequency", o.angular_frequency, "sqrt(g/a)", kAngularFrequencies,
             "angular frequency ω of the plates; auto: from gamma or frequency, or 5");
    t.number("gamma", o.lab.gamma, "-", {0, 1e6},
             "acceleration A omega^2/g, in place of amplitude or frequency");
    t.number("frequency", o.lab.frequency, "Hz", {1e-6, 1e6},
             "of the plates, in place of angular-frequency; needs diameter-mm");
    t.number("amplitude-mm", o.lab.amplitude_mm, "mm", {0, 1e6},
             "of the plates, in place of amplitude; needs diameter-mm");
    t.number("diameter-mm", o.lab.sphere_mm, "mm", {1e-6, 1e6},
             "true diameter a of the spheres, which joins Hz and mm to the units of the run");
    t.also_called("sphere-mm");
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

constexpr double kUsualAmplitude = 0.08;        // [a]
constexpr double kUsualAngularFrequency = 5.0;  // [sqrt(g/a)]

[[noreturn]] void refuse_gamma(double gamma, const std::string& actual, const char* expected) {
    throw OptionError(
        {.problem = fmt::format("vibration.gamma {:g} cannot be reached", gamma),
         .actual = actual,
         .expected = expected,
         .suggestion = "give vibration.amplitude and vibration.angular-frequency instead"});
}

/// A quantity that may be given in units of the simulation, in those of a lab, or in both.
std::optional<double> one_of(const std::string& quantity, const char* name,
                             const std::optional<double>& own, const char* lab_name,
                             const std::optional<double>& lab) {
    if (own && lab) require_agreement(quantity, name, *own, lab_name, *lab);
    return own ? own : lab;
}

/// Of a quantity that follows from others: `given` names them with their values.
void require_in_range(const char* quantity, double derived, const Range& range,
                      const std::string& given) {
    if (derived >= range.minimum && derived <= range.maximum) return;
    throw OptionError({.problem = fmt::format("{} makes {} {:.6g}", given, quantity, derived),
                       .actual = {},
                       .expected = fmt::format("{:g} … {:g}", range.minimum, range.maximum),
                       .suggestion = "check the units: a is the diameter of a sphere"});
}

}  // namespace

VibrationOptions::Motion VibrationOptions::motion(double gravity) const {
    std::optional<double> lab_amplitude, lab_omega;
    if ((lab.frequency || lab.amplitude_mm) && !lab.sphere_mm) {
        throw OptionError({.problem = "a vibration in Hz or mm needs the diameter of the spheres",
                           .actual = "vibration.diameter-mm is not given",
                           .expected = "a [mm]",
                           .suggestion = "or give vibration.gamma, which needs no scale"});
    }
    if (lab.amplitude_mm) {
        lab_amplitude = *lab.amplitude_mm / *lab.sphere_mm;
        require_in_range("an amplitude [a] of", *lab_amplitude, kAmplitudes,
                         fmt::format("vibration.amplitude-mm {:g} with vibration.diameter-mm {:g}",
                                     *lab.amplitude_mm, *lab.sphere_mm));
    }
    if (lab.frequency) {
        lab_omega = 2 * M_PI * *lab.frequency * seconds_of_time_unit(*lab.sphere_mm);
        require_in_range("an angular frequency [sqrt(g/a)] of", *lab_omega, kAngularFrequencies,
                         fmt::format("vibration.frequency {:g} with vibration.diameter-mm {:g}",
                                     *lab.frequency, *lab.sphere_mm));
    }
    const auto a = one_of("the amplitude of the plates [a]", "vibration.amplitude", amplitude,
                          "vibration.amplitude-mm", lab_amplitude);
    const auto omega =
        one_of("the angular frequency of the plates [sqrt(g/a)]", "vibration.angular-frequency",
               angular_frequency, "vibration.frequency", lab_omega);
    if (!lab.gamma) {
        return {a.value_or(kUsualAmplitude), omega.value_or(kUsualAngularFrequency)};
    }
    const double gamma = *lab.gamma;
    if (!(gravity > 0)) refuse_gamma(gamma, "without gravity there is no Γ", "cell.gravity > 0");
    if (a && omega) {
        require_agreement("the acceleration of the plates, Γ = Aω²/g,", "vibration.gamma", gamma,
                          fmt::format("A = {:g} a with ω = {:g} sqrt(g/a)", *a, *omega),
                          *a * *omega * *omega / gravity);
        return {*a, *omega};
    }
    if (a) {
        if (!(*a > 0)) refuse_gamma(gamma, "the amplitude is 0", "an amplitude above 0");
        const double follows = std::sqrt(gamma * gravity / *a);
        require_in_range(
            "an angular frequency [sqrt(g/a)] of", follows, kAngularFrequencies,
            fmt::format("vibration.gamma {:g} with an amplitude of {:g} a", gamma, *a));
        return {*a, follows};
    }
    const double w = omega.value_or(kUsualAngularFrequency);
    if (!(w > 0)) refuse_gamma(gamma, "the angular frequency is 0", "a frequency above 0");
    const double follows = gamma * gravity / (w * w);
    require_in_range(
        "an amplitude [a] of", follows, kAmplitudes,
        fmt::format("vibration.gamma {:g} with an angular frequency of {:g} sqrt(g/a)", gamma, w));
    return {follows, w};
}

void VibrationOptions::make_room_for(const std::function<Given(const std::string& name)>& given) {
    const auto is_given = [&](const char* name) { return given(name) == Given::as_value; };
    const bool has_amplitude = is_given("amplitude") || is_given("amplitude-mm");
    const bool has_frequency = is_given("angular-frequency") || is_given("frequency");
    const auto drop_amplitude = [&] { amplitude = lab.amplitude_mm = std::nullopt; };
    const auto drop_frequency = [&] { angular_frequency = lab.frequency = std::nullopt; };
    if (is_given("gamma")) {
        const bool frequency_follows =
            has_amplitude || given("angular-frequency") == Given::as_auto;
        frequency_follows ? drop_frequency() : drop_amplitude();
    } else if ((has_amplitude && (has_frequency || angular_frequency || lab.frequency)) ||
               (has_frequency && (amplitude || lab.amplitude_mm))) {
        lab.gamma.reset();
    }
    if (has_amplitude) drop_amplitude();
    if (has_frequency) drop_frequency();
    if (is_given("diameter-mm")) {  // mm and Hz are another motion now
        if (lab.amplitude_mm) amplitude.reset();
        if (lab.frequency) angular_frequency.reset();
    }
}

MdSystem MdOptions::system() const {
    MdSystem system;
    system.length = {cell.length_x, cell.length_y, cell.height};
    system.walls_x = cell.sides_x == Side::walls;
    system.walls_y = cell.sides_y == Side::walls;
    system.vertical = cell.vertical;
    system.gravity = cell.gravity;
    const VibrationOptions::Motion motion = vibration.motion(cell.gravity);
    system.amplitude = motion.amplitude;
    system.angular_frequency = motion.angular_frequency;
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
