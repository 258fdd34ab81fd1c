#include <memory>

#include <zlib.h>

#include "analysis/analysis.h"
#include "core/errors.h"
#include "io/h5/checkpoint_file.h"
#include "simulate/field/integrators/adjoint.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"
#include "tests/fuzz/checkpoint_jobs.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

namespace {

std::string with_checksum(std::string_view bytes) {
    const auto sum = static_cast<std::uint32_t>(crc32(crc32(0, nullptr, 0),
                                                      reinterpret_cast<const Bytef*>(bytes.data()),
                                                      static_cast<uInt>(bytes.size())));
    std::string whole(bytes);
    whole.append(reinterpret_cast<const char*>(&sum), sizeof(sum));
    return whole;
}

void restore_md(const Checkpoint& checkpoint) {
    static RunPlan plan;
    static simulate::MdSimulation simulation(
        md_options(), simulate::make_initial_state(md_options(), 1), 1, plan);
    simulation.restore(checkpoint);
    simulation.checkpoint();
    simulation.events();
}

void restore_field(const Checkpoint& checkpoint) {
    static const auto fields = simulate::make_integrator(field_setup(), 1);
    fields->restore(checkpoint);
    fields->advance(1);
}

void restore_adjoint(const Checkpoint& checkpoint) {
    static simulate::AdjointEstimator adjoint(field_setup(), {{1, 0}, {0, 2}}, 1);
    adjoint.restore(checkpoint);
    adjoint.advance(1);
}

void restore_part(const Checkpoint& checkpoint) {
    int parts = 0;
    analysis::merged([&] { return parts++ == 0 ? std::optional(checkpoint) : std::nullopt; },
                     part_options(), {.threads = 1});
}

// A state that does not fit is refused by what takes it, which does not know the file.
bool is_restored(const Checkpoint& checkpoint) {
    try {
        if (checkpoint.kind == "md") restore_md(checkpoint);
        if (checkpoint.kind == "field") restore_field(checkpoint);
        if (checkpoint.kind == "field adjoint") restore_adjoint(checkpoint);
        if (checkpoint.kind.starts_with("analysis")) restore_part(checkpoint);
        return true;
    } catch (const InputError&) {
        return false;
    } catch (const OptionError&) {
        return false;
    }
}

}  // namespace

bool read_checkpoints(std::string_view bytes) {
    const Input input(with_checksum(bytes), ".checkpoint");
    Checkpoint checkpoint;
    return is_taken(input, [&] { checkpoint = io::read_checkpoint(input.path()); }) &&
           is_restored(checkpoint);
}

}  // namespace grainfield::fuzz
