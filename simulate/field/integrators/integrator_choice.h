#pragma once

#include <memory>

#include "simulate/field/integrators/field_integrator.h"

namespace grainfield::simulate {

/// The integrator of `setup.scheme`, in the precision that `setup` asks for.
std::unique_ptr<FieldIntegrator> make_integrator(const FieldSetup& setup, int threads);

}  // namespace grainfield::simulate
