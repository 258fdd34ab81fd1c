#pragma once

#include <cstdint>

#include "core/density_field.h"
#include "simulate/field/field_plan.h"
#include "simulate/field/integrators/field_integrator.h"

namespace grainfield::simulate {

/// All fields of an integrator at its present step.
FieldFrame frame_of(const FieldIntegrator& fields);

/// Throws PhysicsError, naming scheme and step, if a density is not finite, which ∫ρ shows. Only
/// the published scheme can diverge.
void require_finite(const FieldIntegrator& fields);

/// Carries the fields through a schedule and hands out samples and fields to store. It has no state
/// but the step of the fields, so a restored integrator continues where it was.
class FieldRun {
 public:
    FieldRun(FieldIntegrator& fields, const FieldSchedule& schedule, FieldSink& samples,
             FieldSink& stored);

    bool is_done() const { return fields_.step() >= schedule_.total(); }
    /// Advances by at most `at_most` steps, up to the next sample or stored field, and returns the
    /// steps taken. The results do not depend on how a run is cut into calls. Throws PhysicsError
    /// (require_finite) before a sample or a stored field would hold what is not finite.
    std::int64_t advance(std::int64_t at_most);

 private:
    bool is_sample(std::int64_t step) const;
    bool is_stored(std::int64_t step) const;
    std::int64_t next_event() const;

    FieldIntegrator& fields_;
    FieldSchedule schedule_;
    FieldSink& samples_;
    FieldSink& stored_;
};

}  // namespace grainfield::simulate
