#include "simulate/md/engine/engine_choice.h"

#include "simulate/md/engine/event_engine.h"
#include "simulate/md/mechanics/collision_rule.h"

namespace grainfield::simulate {

namespace {

// Friction beyond this is taken as a surface that never slides.
constexpr double always_sticks = 1e6;

Tangential tangential_of(const MdSystem& system) {
    const auto sticks = [](const ContactLaw& law) { return law.static_friction >= always_sticks; };
    if (system.grain.is_smooth() && system.plate.is_smooth()) return Tangential::smooth;
    if (sticks(system.grain) && sticks(system.plate)) return Tangential::sticking;
    return Tangential::coulomb;
}

}  // namespace

std::unique_ptr<Engine> make_engine(const MdSystem& system, const EngineOptions& options) {
    require_valid(system);
    switch (tangential_of(system)) {
        case Tangential::smooth:
            return make_event_engine<Tangential::smooth>(system, options);
        case Tangential::sticking:
            return make_event_engine<Tangential::sticking>(system, options);
        case Tangential::coulomb:
            break;
    }
    return make_event_engine<Tangential::coulomb>(system, options);
}

}  // namespace grainfield::simulate
