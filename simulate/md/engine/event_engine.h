#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/support/huge_pages.h"
#include "core/support/parallel.h"
#include "core/support/team.h"
#include "simulate/md/engine/cell_grid.h"
#include "simulate/md/engine/engine.h"
#include "simulate/md/engine/event_calendar.h"
#include "simulate/md/mechanics/collision_rule.h"
#include "simulate/md/mechanics/first_contact.h"
#include "simulate/md/mechanics/flight.h"
#include "simulate/md/mechanics/plate_time.h"

namespace grainfield::simulate {

/// Partners of a grain that are no grains.
enum Obstacle : std::int32_t {
    nothing = -1,
    low_plate = -2,
    high_plate = -3,
    wall_x_low = -4,
    wall_x_high = -5,
    wall_y_low = -6,
    wall_y_high = -7
};

/// The one event a grain has in the calendar: the earlier of its best collision and the crossing
/// into the next cell. The spin stands here because collisions want both: one cache line.
struct alignas(64) Plan {
    double collision = never;  ///< with `partner`
    double crossing = never;
    Vec3 spin;  ///< [sqrt(g/a)]; stays 0 without friction
    std::int32_t partner = nothing;
    std::uint32_t partner_events = 0;  ///< Grain::events of the partner then
    std::array<std::uint16_t, 3> cell{};
    std::int8_t axis = 0;  ///< of the crossing
    std::int8_t direction = 0;
    std::int32_t id = 0;

    double time() const { return std::min(collision, crossing); }
};

/// Events of a grain in one tick of the clock that stalls (docs/md/engine.md), those alone that
/// follow upon its last one within the resolution of the window.
struct Burst {
    std::uint32_t tick = 0;
    std::uint32_t events = 0;
};

/// What a tile may rely on: everything is its own; or its rim is unknown (core of a strip); or all
/// others are done (the seam between two cores).
enum class TileKind { whole, core, seam };

/// The number of the strip whose core executes the events of a grain, and what threatens it.
using Owner = std::uint16_t;
constexpr Owner threatened_mark = 1 << 15;  ///< the unknown may reach it within the step
constexpr Owner lost_mark = 1 << 14;        ///< the unknown has reached it

/// A strip of cell rows worked on by one thread, with what it needs for itself.
struct Tile {
    TileKind kind = TileKind::whole;
    EventCalendar calendar;
    Ledger ledger;
    std::int64_t taken = 0;  ///< entries taken from the calendar, for its bucket width
    double now = 0;
    double end = 0;       ///< events from here on are left to others
    double step_end = 0;  ///< of a core: what happens from here on waits for the next step
    Owner number = 0;     ///< of the strip
    int first_row = 0;
    int end_row = 0;
    int low_front = 0;   ///< highest row that the unknown reached from below
    int high_front = 0;  ///< lowest row that it reached from above
    std::vector<std::int32_t> unknown;
    bool is_violated = false;  ///< a grain was faster than the front
};

/// The engine for one combination of policies (docs/md/engine.md).
///
/// Invariant: whichever of two neighbouring grains changed last has predicted their collision from
/// both present states. A grain plans only its own earliest event; when that turns out outdated
/// because the partner changed, it predicts anew. pair_time is a pure function of two states, so
/// any order of work that respects causality gives the same trajectory, bit by bit.
template <Tangential tangential, bool has_gravity, Plates plates>
class EventEngine final : public Engine {
 public:
    EventEngine(const MdSystem& system, const EngineOptions& options);

    void load(const GrainState& state, double end) override;
    void advance(double time) override;
    void store(double time, GrainState& state) const override;
    Energies energies(double time) const override;
    const Ledger& ledger() const override { return total_; }
    double max_overlap() const override { return max_overlap_; }
    std::int64_t fallbacks() const override { return fallbacks_; }
    int strips() const override;
    std::size_t bytes() const override;
    std::string policies() const override;

 private:
    static constexpr bool has_spin = tangential != Tangential::smooth;

    void begin_window(Team& team);
    void set_collapse_limits(Team& team);
    void reset_calendar(Tile& tile, double start, double end, std::size_t grains);
    void predict_all(Team& team);
    void start_whole(double start);

    // Strips (event_engine_strips.inl).
    int strip_count() const;
    void advance_strips_or_whole(double time, Team& team);
    bool advance_strips(double time, Team& team);
    double greatest_speed(double time, Team& team) const;
    void begin_cores(int strips, Team& team);
    void run_core(Tile& tile, double start, double end);
    bool run_seams(double start, double end, int strips, Team& team);
    void run_seam(Tile& tile, double end);
    void take_back(Tile& core, int strips);
    void plan_in_core(Tile& tile, std::int32_t i);
    void threaten(Tile& tile, std::int32_t i, double time);
    void lose(Tile& tile, std::int32_t i);
    void loses_neighbours(Tile& tile, std::int32_t i);
    double time_lost(const Tile& tile, std::int32_t i) const;
    double time_reached(std::int32_t i, std::int32_t lost, double now) const;
    bool is_known(std::int32_t i) const { return owner_.empty() || (owner_of(i) & lost_mark) == 0; }
    // A calendar may hold an entry of a grain that has gone to another strip, whose core marks it.
    // Whatever it reads then is not its own number.
    Owner owner_of(std::int32_t i) const {
        return std::atomic_ref<Owner>(owner_[static_cast<std::size_t>(i)])
            .load(std::memory_order_relaxed);
    }
    void set_owner(std::int32_t i, int owner) {
        std::atomic_ref<Owner>(owner_[static_cast<std::size_t>(i)])
            .store(static_cast<Owner>(owner), std::memory_order_relaxed);
    }
    void run(Tile& tile, double end);
    void execute(Tile& tile, std::int32_t i);
    void collide_pair(Tile& tile, std::int32_t i);
    void collide_plate(Tile& tile, std::int32_t i);
    void collide_wall(Tile& tile, std::int32_t i);
    void cross_cell(Tile& tile, std::int32_t i);
    void predict(std::int32_t i, double now);
    class Nearby;
    void consider_around(const Grain& grain, Plan& plan, const std::array<int, 3>& low,
                         const std::array<int, 3>& high) const;
    template <class F>
    void for_each_cell(const std::array<int, 3>& low, const std::array<int, 3>& high, F&& f) const;
    template <class F>
    void for_each_image(const std::array<int, 3>& low, const std::array<int, 3>& high, F&& f) const;
    void consider_side_walls(const Grain& grain, Plan& plan) const;
    void plan_crossing(const Grain& grain, Plan& plan, double now) const;
    double vertical_crossing(const Grain& grain, const Plan& plan, double now,
                             std::int8_t& direction) const;
    void schedule(Tile& tile, std::int32_t i);
    /// When its next event is due: in a core, also that of being lost; never there if it is lost or
    /// another strip's.
    double time_of(const Tile& tile, std::int32_t i) const {
        const auto k = static_cast<std::size_t>(i);
        if (tile.kind != TileKind::core) return plan_[k].time();
        const Owner owner = owner_of(i);
        if (owner == tile.number) return plan_[k].time();
        if (owner != (tile.number | threatened_mark)) return never;
        return std::min(plan_[k].time(), loses_at_[k]);
    }
    /// Whether the tile may read the plan of a grain that its calendar once held.
    bool may_read(const Tile& tile, std::int32_t i) const {
        return tile.kind != TileKind::core || owner_of(i) == tile.number;
    }
    void look_ahead(const Tile& tile, std::int32_t bucket) const;
    template <class F>
    void for_each_row(const Tile& tile, std::int32_t i, F&& f) const;
    template <class F>
    void for_each_grain(int first_row, int end_row, F&& f) const;
    void link(std::int32_t i);
    void unlink(std::int32_t i);
    void count_event(std::int32_t i, std::int32_t partner, double time, double since);
    void count_burst(std::int32_t i, std::int32_t partner, double time);
    void require_pace(std::int32_t i, std::int32_t partner, double time) const;
    double restitution_of(const ContactLaw& law, Tile& tile, std::int32_t i, std::int32_t j,
                          double time);
    double overlap_of(std::size_t i) const;
    [[noreturn]] void report_collapse(std::int32_t i, std::int32_t partner,
                                      const std::string& pace) const;

    MdSystem system_;
    EngineOptions options_;
    PlateSolver plate_solver_;
    ContactSearch search_ = contact_search<has_gravity>();
    CellGrid cells_;
    HugeVector<Grain> grain_;
    HugeVector<Plan> plan_;
    std::vector<double> last_contact_;
    std::vector<Tile> tile_;  ///< one; or all cores, then all seams
    const GrainState* loaded_ = nullptr;
    bool is_whole_ = true;
    bool has_cores_ = false;           ///< the cores hold all events of this window
    mutable HugeVector<Owner> owner_;  ///< strips only
    std::vector<double> lost_at_;      ///< since when a grain is unknown to its core
    std::vector<double> loses_at_;  ///< when that will happen as things stand: of threatened ones
    double front_start_ = 0;
    double front_speed_ = 0;
    double front_margin_ = 0;
    std::int64_t fallbacks_ = 0;  ///< windows that had to be done again with one queue
    Ledger total_;
    double now_ = 0;
    double end_ = 0;
    double collapse_limit_ = 0;         ///< events of one grain in this window
    std::uint32_t unasked_events_ = 0;  ///< of one grain, before its pace is compared with that
    double resolution_ = 0;             ///< of the clock: events closer than this are counted
    HugeVector<Burst> burst_;
    double pair_rebound_ = 0;  ///< least speed at which two grains in contact part (TC model)
    double rate_ = 0;          ///< entries taken per grain and time in the last window
    double max_overlap_ = 0;
    bool fetch_ahead_ = false;
};

template <Tangential tangential>
std::unique_ptr<Engine> make_event_engine(const MdSystem& system, const EngineOptions& options);

}  // namespace grainfield::simulate
