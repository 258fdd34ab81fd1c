#pragma once

#include <cstdint>
#include <vector>

#include "core/density_field.h"
#include "core/frame.h"
#include "core/run_plan.h"
#include "core/trajectory.h"
#include "simulate/field/field_options.h"
#include "simulate/md/md_options.h"
#include "simulate/render/render_options.h"

namespace grainfield::simulate {

/// What every call below may be told, and need not.
struct RunSettings {
    std::uint64_t seed = 1;   ///< of all random streams
    int threads = 0;          ///< 0: all processors; results do not depend on it
    RunPlan* plan = nullptr;  ///< takes what is skipped and why
};

/// Molecular dynamics of a vibrated layer from its initial state to its last period (docs/md.md):
/// the snapshots that `options.run` asks for. Lengths in a, times in sqrt(a/g).
///
/// Throws OptionError if the system cannot be simulated, PhysicsError on inelastic collapse,
/// Interrupted after a caught signal. Memory: every snapshot, 100 bytes a grain.
Trajectory simulate_md(const MdOptions& options, const RunSettings& settings = {});

/// The same into a sink, one snapshot at a time; what it returns has no snapshots.
Trajectory simulate_md(const MdOptions& options, SnapshotSink& sink,
                       const RunSettings& settings = {});

/// The coupled fields ψ and ρ of the continuum model (docs/field.md): one instant every
/// `options.record.sample` after the relaxation. Seed and threads are those of `settings`.
///
/// Throws OptionError if the fields cannot be integrated, or for the adjoint scheme, which has no
/// density; PhysicsError if the published scheme blows up; Interrupted after a caught signal.
std::vector<FieldFrame> simulate_field(const FieldOptions& options,
                                       const RunSettings& settings = {});

/// The same into a sink, one instant at a time.
void simulate_field(const FieldOptions& options, FieldSink& sink, const RunSettings& settings = {});

/// Frames as a camera sees them, and what is in them.
struct RenderedFilm {
    std::vector<Frame> frames;  ///< one a snapshot; `missing` where the camera lost one
    Trajectory truth;           ///< pixels; identities hold for as long as one can follow a grain
};

/// Renders every snapshot of a trajectory (docs/render.md): scene, optics, camera.
///
/// Throws OptionError if the options do not go together or the trajectory is empty; Interrupted
/// after a caught signal.
RenderedFilm render(const Trajectory& trajectory, const RenderOptions& options,
                    const RunSettings& settings = {});

}  // namespace grainfield::simulate
