#include "simulate/md/state/md_system.h"

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::simulate {

namespace {

// A sphere that touches both sides of its gap at once would collide without end.
constexpr double least_gap = 1 + 1e-6;

// The cell grid needs two cells on a periodic axis, each a hair wider than a diameter.
constexpr double least_periodic = 2 + 1e-6;

void require(bool holds, const char* name, double value, const char* expected,
             const char* suggestion = "") {
    if (holds && std::isfinite(value)) return;
    throw OptionError({.problem = fmt::format("{} cannot be simulated", name),
                       .actual = fmt::format("{:g}", value),
                       .expected = expected,
                       .suggestion = suggestion});
}

void require_valid(const ContactLaw& law, const std::string& name) {
    require(law.restitution >= 0 && law.restitution <= 1, (name + ".restitution").c_str(),
            law.restitution, "0 … 1");
    require(law.tangential_restitution >= -1 && law.tangential_restitution <= 1,
            (name + ".tangential-restitution").c_str(), law.tangential_restitution, "-1 … 1");
    require(law.static_friction >= 0, (name + ".static-friction").c_str(), law.static_friction,
            "≥ 0");
    require(law.dynamic_friction >= 0, (name + ".dynamic-friction").c_str(), law.dynamic_friction,
            "≥ 0");
    require(law.dynamic_friction <= law.static_friction, (name + ".dynamic-friction").c_str(),
            law.dynamic_friction, "at most the static friction",
            "raise static-friction or lower dynamic-friction");
}

}  // namespace

double MdSystem::period() const {
    return is_vibrating() ? 2 * std::numbers::pi / angular_frequency : 1;
}

std::optional<ControlValue> control_of(const MdSystem& system) {
    if (!(system.gravity > 0)) return std::nullopt;
    const double omega = system.angular_frequency;
    return ControlValue{.parameter = ControlParameter::acceleration,
                        .value = system.amplitude * omega * omega / system.gravity};
}

void require_valid(const MdSystem& system) {
    for (const auto& [name, value, walls] :
         {std::tuple{"cell.length-x", system.length.x, system.walls_x},
          std::tuple{"cell.length-y", system.length.y, system.walls_y}}) {
        require(value >= (walls ? least_gap : least_periodic) && value <= 60000, name, value,
                walls ? "1.000001 … 60000 a between walls"
                      : "2.000001 … 60000 a with periodic boundaries",
                "make the box larger");
    }
    const bool periodic_z = system.vertical == Vertical::periodic;
    require(
        system.length.z >= (periodic_z ? least_periodic : least_gap) && system.length.z <= 60000,
        "cell.height", system.length.z,
        periodic_z ? "2.000001 … 60000 a with periodic boundaries" : "1.000001 … 60000 a",
        periodic_z ? "make the box larger" : "a sphere must move between the plates");
    require(system.gravity >= 0, "cell.gravity", system.gravity, "≥ 0");
    require(!periodic_z || system.gravity == 0, "cell.gravity", system.gravity,
            "0 where the vertical direction is periodic", "set vertical = \"plates\"");
    require(!periodic_z || !system.is_vibrating(), "vibration.amplitude", system.amplitude,
            "0 where the vertical direction is periodic", "set vertical = \"plates\"");
    require(system.amplitude >= 0, "vibration.amplitude", system.amplitude, "≥ 0");
    require(system.angular_frequency >= 0, "vibration.angular-frequency", system.angular_frequency,
            "≥ 0");
    require(system.contact_time >= 0, "run.contact-time", system.contact_time, "≥ 0");
    require(system.plate_tolerance >= 1e-16 && system.plate_tolerance <= 1e-2,
            "run.plate-tolerance", system.plate_tolerance, "1e-16 … 0.01 a");
    require_valid(system.grain, "grain");
    require_valid(system.plate, "plate");
}

}  // namespace grainfield::simulate
