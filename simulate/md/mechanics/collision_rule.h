#pragma once

#include <cmath>

#include "core/vec3.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

/// Which tangential forces a scene needs, known before it starts: none; always as much as sticking
/// takes; or Coulomb's choice between sticking and sliding.
enum class Tangential { smooth, sticking, coulomb };

/// What a contact does to the body on the side that n points to.
struct Impulse {
    Vec3 j;             ///< [m sqrt(g a)]
    double normal = 0;  ///< n·j ≥ 0
    double loss = 0;    ///< energy turned into heat [m g a]
    bool slides = false;
};

/// The impulse of a collision of rough hard spheres (walton1993):
///
///   J_n = −m_eff (1 + e) u_n,
///   |J_t| = m_eff (2/7)(1 + β0)|u_t|  if that is ≤ μ_s J_n, else μ_d J_n,  along −u_t,
///   loss = ½ m_eff (1 − e²) u_n² + |J_t||u_t| − (7/4) J_t²/m_eff.
///
/// u: velocity of the contact point of body 1 relative to body 2 [sqrt(g a)]; n: unit vector from 2
/// to 1; m_eff = ½ for two grains, 1 for a grain and a plate; 2/7 belongs to I = 1/10 m a².
/// Approach (u_n < 0) is the caller's business: a receding pair would be drawn together.
/// `restitution` stands apart from the law because the TC model replaces it by 1.
template <Tangential tangential>
inline Impulse impulse_of(const Vec3& n, const Vec3& u, double m_eff, double restitution,
                          const ContactLaw& law) {
    const double un = dot(u, n);
    Impulse result;
    result.normal = -m_eff * (1 + restitution) * un;
    // 1 − e² as a product, which keeps its digits for e → 1.
    result.loss = 0.5 * m_eff * ((1 - restitution) * (1 + restitution)) * un * un;
    result.j = result.normal * n;
    if constexpr (tangential == Tangential::smooth) return result;
    const Vec3 ut = u - un * n;
    const double factor = m_eff * (2.0 / 7.0) * (1 + law.tangential_restitution);
    const double ut2 = squared_norm(ut);
    const double stick2 = factor * factor * ut2;
    if constexpr (tangential == Tangential::coulomb) {
        const double bound = law.static_friction * result.normal;
        if (stick2 > bound * bound) {
            const double speed = std::sqrt(ut2);
            const double jt = law.dynamic_friction * result.normal;
            result.j -= (jt / speed) * ut;
            result.loss += jt * speed - 1.75 * jt * jt / m_eff;
            result.slides = true;
            return result;
        }
    }
    result.j -= factor * ut;
    result.loss += factor * ut2 - 1.75 * stick2 / m_eff;
    return result;
}

/// Raises the speed at which body 1 leaves body 2, u_n + J_n/m_eff, to `least`; the energy for it
/// counts as negative loss. A receding body gets no other impulse. Whether it had to.
inline bool raise_rebound(Impulse& impulse, const Vec3& n, double un, double m_eff, double least) {
    if (!(impulse.normal > 0)) impulse = {};
    const double rebound = un + impulse.normal / m_eff;
    const double more = least - rebound;
    if (!(more > 0)) return false;
    impulse.normal += m_eff * more;
    impulse.j += (m_eff * more) * n;
    impulse.loss -= m_eff * more * (rebound + 0.5 * more);
    return true;
}

/// Contact velocity u = v1 − v2 − ½(ω1 + ω2) × n of two grains, a = 1.
inline Vec3 contact_velocity(const Vec3& v1, const Vec3& v2, const Vec3& spin1, const Vec3& spin2,
                             const Vec3& n) {
    return v1 - v2 - 0.5 * cross(spin1 + spin2, n);
}

/// Change of spin Δω = −½ n × J / I of both grains, I = 1/10.
inline Vec3 spin_change(const Vec3& n, const Vec3& j) {
    return -5.0 * cross(n, j);
}

}  // namespace grainfield::simulate
