// The body of EventEngine, for the files that instantiate it: windows and the loop over events.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "simulate/md/engine/event_engine.h"
#include "simulate/md/engine/event_engine_collisions.inl"
#include "simulate/md/engine/event_engine_predictions.inl"
#include "simulate/md/engine/event_engine_strips.inl"

namespace grainfield::simulate {

// Below this size data are near anyway and looking ahead costs more than it saves.
constexpr std::size_t cached_grains = 20000;

// Way [a] in a window within which EngineOptions::event_limit is meant, and what a grain can count.
constexpr double free_way = 1000;
constexpr double most_events = 4e9;
// The clock stalls where a grain has events closer than this part of the time in which the fastest
// goes 1 a, again and again. Rounding of the times needs some more.
constexpr double stalled = 1e-8;
constexpr double roundings = 64;
// Speed at which grains in contact part, as a share of the fastest.
constexpr double parting = 1e-9;
// A signal is asked for after so many entries of the calendar: some 10 ms.
constexpr std::int64_t entries_unasked = 1 << 13;

template <Tangential tangential, bool has_gravity, Plates plates>
EventEngine<tangential, has_gravity, plates>::EventEngine(const MdSystem& system,
                                                          const EngineOptions& options)
    : system_(system), options_(options), plate_solver_(system), cells_(system) {
    tile_.resize(1);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::load(const GrainState& state, double end) {
    loaded_ = &state;
    end_ = end;
    on_team(options_.threads, [this](Team& team) { begin_window(team); });
    is_whole_ = strip_count() < 2;
    if (is_whole_) start_whole(0);
}

// Everything as loaded, at time 0, all collisions predicted.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::begin_window(Team& team) {
    const GrainState& state = *loaded_;
    const std::size_t count = state.size();
    grain_.resize(count);
    plan_.resize(count);
    last_contact_ = state.last_contact;
    std::fill(cells_.cell.begin(), cells_.cell.end(), Cell{});
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3& r = state.position[i];
        grain_[i] = {.r = r, .v = state.velocity[i], .t = 0, .next = -1, .events = 0};
        Plan plan;
        plan.cell = {static_cast<std::uint16_t>(cells_.coordinate(r.x, 0)),
                     static_cast<std::uint16_t>(cells_.coordinate(r.y, 1)),
                     static_cast<std::uint16_t>(cells_.coordinate(r.z, 2))};
        if constexpr (has_spin) plan.spin = state.spin[i];
        plan.id = state.id[i];
        plan_[i] = plan;
    }
    for (std::size_t i = 0; i < count; ++i) link(static_cast<std::int32_t>(i));
    has_cores_ = false;
    fetch_ahead_ = count > cached_grains;
    now_ = 0;
    set_collapse_limits(team);
    burst_.assign(count, {});
    total_ = {};
    for (Tile& tile : tile_) {
        tile.ledger = {};
        tile.taken = 0;
    }
    predict_all(team);
}

// A grain that flies far meets many: the limit grows with the way that the fastest of this window
// can go, so that no hot gas is taken for a collapse. No fall is deeper than the cell is high.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::set_collapse_limits(Team& team) {
    const double fall = has_gravity ? std::sqrt(2 * system_.gravity * system_.length.z) : 0;
    const double speed = greatest_speed(0, team) + plate_solver_.speed_bound + fall;
    const double way = speed * end_;
    collapse_limit_ = std::min(options_.event_limit * (1 + way / free_way), most_events);
    unasked_events_ = static_cast<std::uint32_t>(free_share * collapse_limit_);
    const double rounding = roundings * std::numeric_limits<double>::epsilon() * end_;
    // As off the low plate; without forces, enough for rounding not to bring them back.
    pair_rebound_ = std::max(plate_solver_.least_rebound(false), parting * speed);
    resolution_ = std::max(stalled / std::max(speed, 1e-300), rounding);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::predict_all(Team& team) {
    constexpr std::size_t chunk = 4096;
    const std::size_t count = grain_.size();
    const auto chunks = static_cast<std::int64_t>((count + chunk - 1) / chunk);
    std::vector<double> overlap(static_cast<std::size_t>(chunks), 0);
    team.for_each(chunks, [&](std::int64_t c) {
        const auto k = static_cast<std::size_t>(c);
        for (std::size_t i = k * chunk; i < std::min(count, (k + 1) * chunk); ++i) {
            overlap[k] = std::max(overlap[k], overlap_of(i));
            predict(static_cast<std::int32_t>(i), 0);
        }
    });
    max_overlap_ = 0;
    for (const double o : overlap) max_overlap_ = std::max(max_overlap_, o);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::start_whole(double start) {
    is_whole_ = true;
    owner_.clear();
    Tile& tile = tile_.front();
    tile.kind = TileKind::whole;
    tile.now = start;
    reset_calendar(tile, start, end_, grain_.size());
    for (std::size_t i = 0; i < grain_.size(); ++i) schedule(tile, static_cast<std::int32_t>(i));
}

// Empty, for the events of so many grains in [start, end).
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::reset_calendar(Tile& tile, double start,
                                                                  double end, std::size_t grains) {
    const double rate = rate_ > 0 ? rate_ : 20;
    tile.end = end;
    tile.calendar.reset(start, end, rate * (end - start) * static_cast<double>(grains));
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::schedule(Tile& tile, std::int32_t i) {
    if (tile.kind != TileKind::whole) {
        const Vec3& v = grain_[static_cast<std::size_t>(i)].v;
        const double bound = front_speed_ - front_margin_;
        if (squared_norm(v) > bound * bound) tile.is_violated = true;
    }
    if (tile.kind == TileKind::core) {
        plan_in_core(tile, i);
        return;
    }
    const Plan& plan = plan_[static_cast<std::size_t>(i)];
    if (const double time = plan.time(); time < tile.end) tile.calendar.push({time, plan.id, i});
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::advance(double time) {
    if (is_whole_) {
        run(tile_.front(), time);
    } else {
        on_team(options_.threads, [&](Team& team) { advance_strips_or_whole(time, team); });
    }
    now_ = time;
    total_ = {};
    std::int64_t taken = 0;
    for (const Tile& tile : tile_) {
        total_.add(tile.ledger);
        taken += tile.taken;
    }
    if (time >= end_ && end_ > 0 && !grain_.empty()) {
        rate_ =
            std::max(static_cast<double>(taken) / (end_ * static_cast<double>(grain_.size())), 1.0);
    }
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::run(Tile& tile, double end) {
    const auto planned = [this, &tile](std::int32_t i) { return time_of(tile, i); };
    const auto fetch = [this, &tile](std::int32_t bucket) {
        if (fetch_ahead_) look_ahead(tile, bucket);
    };
    while (const EventCalendar::Entry* entry = tile.calendar.front(planned, fetch, end)) {
        if (entry->time >= end) break;
        const std::int32_t i = entry->grain;
        const double time = entry->time;
        tile.calendar.pop();
        if (++tile.taken % entries_unasked == 0) throw_if_interrupted("a window of the run");
        if (planned(i) != time) continue;
        tile.ledger.backwards = std::max(tile.ledger.backwards, tile.now - time);
        tile.now = time;
        if (tile.kind == TileKind::core && owner_of(i) != tile.number &&
            loses_at_[static_cast<std::size_t>(i)] == time) {
            lose(tile, i);
            continue;
        }
        execute(tile, i);
    }
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::execute(Tile& tile, std::int32_t i) {
    const Plan& plan = plan_[static_cast<std::size_t>(i)];
    if (plan.crossing < plan.collision) {
        cross_cell(tile, i);
    } else if (plan.partner >= 0) {
        const Grain& partner = grain_[static_cast<std::size_t>(plan.partner)];
        if (partner.events == plan.partner_events) {
            if (tile.kind == TileKind::seam && is_known(plan.partner)) tile.is_violated = true;
            collide_pair(tile, i);
        } else {
            ++tile.ledger.outdated;
            predict(i, tile.now);
            schedule(tile, i);
        }
    } else if (plan.partner >= high_plate) {
        if constexpr (plates != Plates::none) collide_plate(tile, i);
    } else {
        collide_wall(tile, i);
    }
}

// The data of coming events are fetched in stages, each of which needs what the one before it
// brought: grain and plan; the partner's plan; the cells around both; the grains in these cells.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::look_ahead(const Tile& tile,
                                                              std::int32_t bucket) const {
    tile.calendar.for_each(bucket + 5, [this](std::int32_t i) {
        fetch_line(&grain_[static_cast<std::size_t>(i)]);
        fetch_line(&plan_[static_cast<std::size_t>(i)]);
    });
    tile.calendar.for_each(bucket + 4, [this, &tile](std::int32_t i) {
        if (!may_read(tile, i)) return;
        const std::int32_t partner = plan_[static_cast<std::size_t>(i)].partner;
        if (partner >= 0) fetch_line(&plan_[static_cast<std::size_t>(partner)]);
    });
    tile.calendar.for_each(bucket + 3, [this, &tile](std::int32_t i) {
        for_each_row(tile, i, [this](std::size_t first, std::size_t last) {
            fetch_line(&cells_.cell[first]);
            fetch_line(&cells_.cell[last]);
        });
    });
    // Without branches: an empty place fetches grain 0 once more.
    tile.calendar.for_each(bucket + 1, [this, &tile](std::int32_t i) {
        for_each_row(tile, i, [this](std::size_t first, std::size_t last) {
            for (std::size_t c = first; c <= last; ++c) {
                for (const std::int32_t j : cells_.cell[c].id) {
                    fetch_line(&grain_[static_cast<std::size_t>(std::max(j, 0))]);
                }
            }
        });
    });
}

// The rows of cells around a grain and its partner, as indices of the first and the last cell.
// Nothing for grains at the rim, nor twice for a pair that both partners have planned.
template <Tangential tangential, bool has_gravity, Plates plates>
template <class F>
void EventEngine<tangential, has_gravity, plates>::for_each_row(const Tile& tile, std::int32_t i,
                                                                F&& f) const {
    if (!may_read(tile, i)) return;
    const Plan& plan = plan_[static_cast<std::size_t>(i)];
    // Near the rim of a core, partner and cells may belong to another thread.
    if (tile.kind == TileKind::core &&
        (plan.cell[1] < tile.first_row + 3 || plan.cell[1] + 3 >= tile.end_row)) {
        return;
    }
    if (!cells_.is_inside(plan.cell[0], plan.cell[1], plan.cell[2])) return;
    std::array<int, 3> low{plan.cell[0], plan.cell[1], plan.cell[2]};
    std::array<int, 3> high = low;
    if (plan.partner >= 0 && may_read(tile, plan.partner)) {
        const Plan& other = plan_[static_cast<std::size_t>(plan.partner)];
        if (other.partner == i && plan.partner < i) return;
        if (cells_.is_inside(other.cell[0], other.cell[1], other.cell[2])) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min<int>(low[axis], other.cell[axis]);
                high[axis] = std::max<int>(high[axis], other.cell[axis]);
            }
        }
    }
    const int deep = cells_.count[2] > 1 ? 1 : 0;
    for (int z = low[2] - deep; z <= high[2] + deep; ++z) {
        for (int y = low[1] - 1; y <= high[1] + 1; ++y) {
            f(cells_.index(low[0] - 1, y, z), cells_.index(high[0] + 1, y, z));
        }
    }
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::store(double time, GrainState& state) const {
    const bool has_contacts = !last_contact_.empty();
    state.last_contact.resize(last_contact_.size());
    state.resize(grain_.size());
    for (std::size_t i = 0; i < grain_.size(); ++i) {
        Vec3 r = grain_[i].r;
        Vec3 v = grain_[i].v;
        fly(r, v, time - grain_[i].t, has_gravity ? system_.gravity : 0);
        const auto wrap = [](double x, double length) {
            if (x < 0) x += length;
            return x >= length ? x - length : x;
        };
        if (cells_.periodic[0]) r.x = wrap(r.x, cells_.length[0]);
        if (cells_.periodic[1]) r.y = wrap(r.y, cells_.length[1]);
        if (cells_.periodic[2]) r.z = wrap(r.z, cells_.length[2]);
        state.position[i] = r;
        state.velocity[i] = v;
        state.spin[i] = plan_[i].spin;
        state.id[i] = plan_[i].id;
        if (has_contacts) state.last_contact[i] = last_contact_[i] - time;
    }
}

template <Tangential tangential, bool has_gravity, Plates plates>
Energies EventEngine<tangential, has_gravity, plates>::energies(double time) const {
    // Neumaier's sum: an audit to 1e-10 over 1e7 events leaves no room for the rounding of N terms.
    struct Sum {
        double sum = 0;
        double rest = 0;
        void add(double x) {
            const double t = sum + x;
            rest += std::abs(sum) >= std::abs(x) ? (sum - t) + x : (x - t) + sum;
            sum = t;
        }
        void add(const Sum& other) {
            add(other.sum);
            rest += other.rest;
        }
        double value() const { return sum + rest; }
    };
    struct Sums {
        Sum horizontal, vertical, rotational, potential;
    };
    // Chunks of fixed size, added in their order: the same bits for any number of threads.
    constexpr std::size_t chunk = 16384;
    const std::size_t count = grain_.size();
    const auto chunks = static_cast<std::int64_t>((count + chunk - 1) / chunk);
    std::vector<Sums> part(static_cast<std::size_t>(chunks));
    const double g = has_gravity ? system_.gravity : 0;
    parallel_for(chunks, options_.threads, [&](std::int64_t c) {
        const auto k = static_cast<std::size_t>(c);
        Sums sums;
        for (std::size_t i = k * chunk; i < std::min(count, (k + 1) * chunk); ++i) {
            Vec3 r = grain_[i].r;
            Vec3 v = grain_[i].v;
            fly(r, v, time - grain_[i].t, g);
            sums.horizontal.add(0.5 * (v.x * v.x + v.y * v.y));
            sums.vertical.add(0.5 * v.z * v.z);
            if constexpr (has_spin) sums.rotational.add(0.05 * squared_norm(plan_[i].spin));
            if constexpr (has_gravity) sums.potential.add(g * r.z);
        }
        part[k] = sums;
    });
    Sums all;
    for (const Sums& sums : part) {
        all.horizontal.add(sums.horizontal);
        all.vertical.add(sums.vertical);
        all.rotational.add(sums.rotational);
        all.potential.add(sums.potential);
    }
    return {all.horizontal.value(), all.vertical.value(), all.rotational.value(),
            all.potential.value()};
}

template <Tangential tangential, bool has_gravity, Plates plates>
std::size_t EventEngine<tangential, has_gravity, plates>::bytes() const {
    std::size_t sum = grain_.capacity() * sizeof(Grain) + plan_.capacity() * sizeof(Plan) +
                      last_contact_.capacity() * sizeof(double) +
                      cells_.cell.capacity() * sizeof(Cell) + owner_.capacity() * sizeof(Owner) +
                      (lost_at_.capacity() + loses_at_.capacity()) * sizeof(double);
    for (const Tile& tile : tile_) sum += tile.calendar.bytes();
    return sum;
}

template <Tangential tangential, bool has_gravity, Plates plates>
std::string EventEngine<tangential, has_gravity, plates>::policies() const {
    const char* contact = tangential == Tangential::smooth     ? "smooth"
                          : tangential == Tangential::sticking ? "sticking"
                                                               : "Coulomb friction";
    const char* walls = plates == Plates::none      ? "no plates"
                        : plates == Plates::at_rest ? "plates at rest"
                                                    : "vibrating plates";
    return fmt::format("{}, {}, {}", contact, has_gravity ? "gravity" : "no gravity", walls);
}

template <Tangential tangential>
std::unique_ptr<Engine> make_event_engine(const MdSystem& system, const EngineOptions& options) {
    const bool gravity = system.gravity > 0;
    if (system.vertical == Vertical::periodic) {
        return std::make_unique<EventEngine<tangential, false, Plates::none>>(system, options);
    }
    if (system.is_vibrating() && gravity) {
        return std::make_unique<EventEngine<tangential, true, Plates::vibrating>>(system, options);
    }
    if (system.is_vibrating()) {
        return std::make_unique<EventEngine<tangential, false, Plates::vibrating>>(system, options);
    }
    if (gravity) {
        return std::make_unique<EventEngine<tangential, true, Plates::at_rest>>(system, options);
    }
    return std::make_unique<EventEngine<tangential, false, Plates::at_rest>>(system, options);
}

}  // namespace grainfield::simulate
