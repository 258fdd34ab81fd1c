#pragma once

#include <cstdint>
#include <optional>

#include "core/run_identity.h"
#include "core/vec3.h"

namespace grainfield::simulate {

/// How two bodies bounce (collision_rule.h).
struct ContactLaw {
    double restitution = 0.998;         ///< e, normal [-] 0 … 1
    double tangential_restitution = 0;  ///< β0 of sticking contacts [-] −1 … 1
    double static_friction = 0.03;      ///< μ_s, sticks up to it [-]
    double dynamic_friction = 0.03;     ///< μ_d, of sliding contacts [-]

    /// No tangential force can act: neither friction nor tangential restitution.
    bool is_smooth() const {
        return tangential_restitution == -1 || (static_friction == 0 && dynamic_friction == 0);
    }
    friend bool operator==(const ContactLaw&, const ContactLaw&) = default;
};

enum class Vertical { plates, periodic };

/// The mechanical system: hard spheres of mass 1, diameter 1 and moment of inertia 1/10 between
/// plates at A sin ωt and A sin ωt + L_z, units m = a = g = 1 (castillo2019).
struct MdSystem {
    Vec3 length{100, 100, 1.84};  ///< [a]
    bool walls_x = false;         ///< hard side walls instead of periodic images
    bool walls_y = false;
    Vertical vertical = Vertical::plates;
    double gravity = 1;              ///< [g]
    double amplitude = 0;            ///< A [a]
    double angular_frequency = 0;    ///< ω [sqrt(g/a)]
    ContactLaw grain;                ///< grain against grain
    ContactLaw plate;                ///< grain against plates and side walls
    double contact_time = 0;         ///< t_c of the TC model, 0: off [sqrt(a/g)] (luding1998)
    double plate_tolerance = 1e-15;  ///< gap at which a grain counts as touching a plate [a]

    bool is_vibrating() const { return amplitude > 0 && angular_frequency > 0; }
    /// 2π/ω, or 1 where nothing vibrates [sqrt(a/g)].
    double period() const;
};

/// Γ = Aω²/g, where gravity is there.
std::optional<ControlValue> control_of(const MdSystem& system);

/// Throws OptionError (name, value, remedy) if the system cannot be simulated.
void require_valid(const MdSystem& system);

}  // namespace grainfield::simulate
