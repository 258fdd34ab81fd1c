#include "simulate/field/field_run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::simulate {

namespace {

std::int64_t next_multiple(std::int64_t step, std::int64_t start, std::int64_t distance) {
    if (step < start) return start + distance;
    return start + ((step - start) / distance + 1) * distance;
}

}  // namespace

FieldFrame frame_of(const FieldIntegrator& fields) {
    const FieldSetup& setup = fields.setup();
    FieldFrame frame;
    frame.dimension = setup.lattice.dimension;
    for (int r = 0; r < setup.replicas; ++r) frame.density.push_back(fields.density(r));
    if (setup.has_order) frame.order = fields.order();
    frame.mean_diffusivity = fields.mean_diffusivity();
    return frame;
}

void require_finite(const FieldIntegrator& fields) {
    const FieldSetup& setup = fields.setup();
    for (int r = 0; r < setup.replicas; ++r) {
        if (std::isfinite(fields.mass(r))) continue;
        throw PhysicsError(
            {.problem = fmt::format("the density is no longer finite at step {}", fields.step()),
             .actual = fmt::format("scheme {} at dt = {:g}",
                                   setup.scheme == FieldScheme::paper ? "paper"
                                   : setup.scheme == FieldScheme::lod ? "lod"
                                                                      : "explicit",
                                   setup.dt),
             .expected = "a step at which the scheme is stable",
             .suggestion = "take a smaller dt, or scheme = \"lod\", which is stable at any"});
    }
}

FieldRun::FieldRun(FieldIntegrator& fields, const FieldSchedule& schedule, FieldSink& samples,
                   FieldSink& stored)
    : fields_(fields), schedule_(schedule), samples_(samples), stored_(stored) {}

bool FieldRun::is_sample(std::int64_t step) const {
    return step > schedule_.relax && (step - schedule_.relax) % schedule_.between_samples == 0;
}

bool FieldRun::is_stored(std::int64_t step) const {
    if (step == schedule_.total()) return true;
    return schedule_.between_stores > 0 && step > schedule_.relax &&
           (step - schedule_.relax) % schedule_.between_stores == 0;
}

std::int64_t FieldRun::next_event() const {
    const std::int64_t now = fields_.step();
    std::int64_t next = next_multiple(now, schedule_.relax, schedule_.between_samples);
    if (schedule_.between_stores > 0) {
        next = std::min(next, next_multiple(now, schedule_.relax, schedule_.between_stores));
    }
    return std::min(next, schedule_.total());
}

std::int64_t FieldRun::advance(std::int64_t at_most) {
    const std::int64_t steps =
        std::min(next_event() - fields_.step(), std::max<std::int64_t>(at_most, 1));
    if (steps <= 0) return 0;
    fields_.advance(steps);
    const std::int64_t now = fields_.step();
    if (!is_sample(now) && !is_stored(now)) return steps;
    require_finite(fields_);
    const FieldFrame frame = frame_of(fields_);
    if (is_sample(now)) samples_.write(frame);
    if (is_stored(now)) stored_.write(frame);
    return steps;
}

}  // namespace grainfield::simulate
