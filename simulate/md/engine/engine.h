#pragma once

#include <cstdint>
#include <string>

#include "core/errors.h"
#include "simulate/md/engine/ledger.h"
#include "simulate/md/state/grain_state.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

struct EngineOptions {
    int threads = 1;
    int tiles = 0;             ///< strips of cell rows; 0: as the threads need
    double event_limit = 1e6;  ///< events of one grain that mean collapse, in a window in which no
                               ///< grain can go far (1,000 a); grows in proportion to the way. A
                               ///< pace that will exceed it is reported after 2 % of them
};

/// Grains collide without end. The window cannot go on; the state that it began with can, with
/// another contact time or event limit.
class InelasticCollapse : public PhysicsError {
 public:
    using PhysicsError::PhysicsError;
};

/// Energies and mean squares of all grains at one instant.
struct Energies {
    double horizontal = 0;  ///< ½ Σ (v_x² + v_y²) [m g a]
    double vertical = 0;    ///< ½ Σ v_z²
    double rotational = 0;  ///< ½ I Σ ω²
    double potential = 0;   ///< Σ g z

    double total() const { return horizontal + vertical + rotational + potential; }
};

/// Event-driven molecular dynamics of one MdSystem (docs/md.md).
///
/// Between two calls of load() lies a *window*: times count from its beginning and every grain
/// carries its own last-event time. The trajectory depends on the loaded state alone: not on
/// threads, tiles, or on where advance() pauses.
class Engine {
 public:
    virtual ~Engine() = default;

    /// Starts a window with this state at time 0, at which the plates pass their mean position
    /// upwards: where plates vibrate, windows must last whole periods. `end`: longest time that
    /// advance() will be asked for. The state must stay as it is until the window ends.
    virtual void load(const GrainState& state, double end) = 0;

    /// Executes all events up to `time` (of the window). Throws InelasticCollapse naming pair and
    /// time if grains collide without end, the same for any number of threads; Interrupted, some 10
    /// ms after a signal. Either way the window cannot go on.
    virtual void advance(double time) = 0;

    /// All grains flown to `time`, which no event may separate from the present; changes nothing.
    virtual void store(double time, GrainState& state) const = 0;

    /// The same of all grains, compensated sums.
    virtual Energies energies(double time) const = 0;

    /// What happened since load().
    virtual const Ledger& ledger() const = 0;

    /// Deepest overlap of two grains, or of grain and plate, in the loaded state [a]; 0 if none.
    virtual double max_overlap() const = 0;

    /// Windows so far that several strips had to do again with one queue; same results.
    virtual std::int64_t fallbacks() const = 0;

    /// Strips of cell rows that are worked on at a time: what the threads and the size allow.
    virtual int strips() const = 0;

    virtual std::size_t bytes() const = 0;
    virtual std::string policies() const = 0;  ///< "coulomb, gravity, vibrating plates"
};

}  // namespace grainfield::simulate
