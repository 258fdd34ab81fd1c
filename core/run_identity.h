#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/unit.h"

namespace grainfield {

/// Where particles or fields come from.
enum class Origin : std::uint8_t { video, md, rendered, points, field };

/// What an experiment or a simulation is driven with.
enum class ControlParameter : std::uint8_t {
    acceleration,      ///< Γ = Aω²/g of the vibration
    critical_distance  ///< ν of the field model
};

/// "Γ", "ν"
const char* symbol(ControlParameter parameter);

struct ControlValue {
    ControlParameter parameter = ControlParameter::acceleration;
    double value = 0;
    Unit unit{};

    friend bool operator==(const ControlValue&, const ControlValue&) = default;
};

enum class RunRole : std::uint8_t {
    run,            ///< one run at one value of the control parameter
    critical_point  ///< what many runs of one series say together
};

/// What a run is and at which control parameter: what legends name and what puts runs side by
/// side. Written by whoever makes the run, stored with it, never guessed from names of options.
struct RunIdentity {
    Origin origin = Origin::points;
    RunRole role = RunRole::run;
    std::optional<ControlValue> control{};
    int dimension = 2;                       ///< 1: a field on a line
    std::optional<double> gradient_order{};  ///< b of the field model

    bool is_field() const { return origin == Origin::field; }  ///< lengths in l, not in a

    friend bool operator==(const RunIdentity&, const RunIdentity&) = default;
};

/// Whether two runs, or critical points of runs, differ in the control parameter alone.
bool same_series(const RunIdentity& a, const RunIdentity& b);

/// "tracked", "true positions", "MD", "points", "field, 2D, b = 4".
std::string series_text(const RunIdentity& identity);

/// "MD, Γ = 2.25"; the series alone where the control parameter is not known.
std::string legend_of(const RunIdentity& identity);

}  // namespace grainfield
