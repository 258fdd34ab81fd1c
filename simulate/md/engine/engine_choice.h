#pragma once

#include <memory>

#include "simulate/md/engine/engine.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

/// The engine compiled for what this system needs and nothing else: spin or none, gravity or none,
/// plates vibrating, at rest or absent. Throws OptionError if the system cannot be simulated.
std::unique_ptr<Engine> make_engine(const MdSystem& system, const EngineOptions& options);

}  // namespace grainfield::simulate
