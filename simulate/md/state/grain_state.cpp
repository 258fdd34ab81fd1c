#include "simulate/md/state/grain_state.h"

namespace grainfield::simulate {

void GrainState::resize(std::size_t count) {
    position.resize(count);
    velocity.resize(count);
    spin.resize(count);
    id.resize(count);
    if (!last_contact.empty()) last_contact.resize(count);
}

}  // namespace grainfield::simulate
