// Events of EventEngine that change grains.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "simulate/md/engine/event_engine.h"

namespace grainfield::simulate {

// Share of the limit of events that a grain may use up at any pace.
constexpr double free_share = 0.02;

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::collide_pair(Tile& tile, std::int32_t i) {
    const auto a = static_cast<std::size_t>(i);
    const auto b = static_cast<std::size_t>(plan_[a].partner);
    const double time = plan_[a].collision;
    Grain& g1 = grain_[a];
    Grain& g2 = grain_[b];
    const double g = has_gravity ? system_.gravity : 0;
    const double since1 = time - g1.t;
    const double since2 = time - g2.t;
    fly(g1.r, g1.v, since1, g);
    fly(g2.r, g2.v, since2, g);
    g1.t = g2.t = time;
    Vec3 n = g1.r - g2.r;
    const auto nearest = [](double d, double length) {
        return d > 0.5 * length ? d - length : (d < -0.5 * length ? d + length : d);
    };
    if (cells_.periodic[0]) n.x = nearest(n.x, cells_.length[0]);
    if (cells_.periodic[1]) n.y = nearest(n.y, cells_.length[1]);
    if (cells_.periodic[2]) n.z = nearest(n.z, cells_.length[2]);
    const double square = squared_norm(n);
    if (1 - square > tile.ledger.deepest_pair.depth) {
        tile.ledger.deepest_pair = {1 - square, plan_[a].id, plan_[b].id, time};
    }
    n = (1 / std::sqrt(square)) * n;
    Vec3 u = g1.v - g2.v;
    if constexpr (has_spin) u = contact_velocity(g1.v, g2.v, plan_[a].spin, plan_[b].spin, n);
    const std::int64_t contacts = tile.ledger.contact_time;
    const double e = restitution_of(system_.grain, tile, i, plan_[a].partner, time);
    Impulse impulse = impulse_of<tangential>(n, u, 0.5, e, system_.grain);
    if (tile.ledger.contact_time > contacts) {
        tile.ledger.resting += raise_rebound(impulse, n, dot(n, u), 0.5, pair_rebound_);
    }
    if (impulse.normal > 0) {
        g1.v += impulse.j;
        g2.v -= impulse.j;
        if constexpr (has_spin) {
            const Vec3 change = spin_change(n, impulse.j);
            plan_[a].spin += change;
            plan_[b].spin += change;
        }
        tile.ledger.pair_loss.add(impulse.loss);
        tile.ledger.pair_virial.add(impulse.normal);
        tile.ledger.sliding += impulse.slides;
    }
    ++tile.ledger.pair;
    const auto j = static_cast<std::int32_t>(b);
    count_event(i, j, time, since1);
    count_event(j, i, time, since2);
    predict(i, time);
    schedule(tile, i);
    predict(j, time);
    schedule(tile, j);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::collide_plate(Tile& tile, std::int32_t i) {
    const auto a = static_cast<std::size_t>(i);
    const double time = plan_[a].collision;
    const std::int32_t partner = plan_[a].partner;
    const bool is_high = partner == high_plate;
    Grain& grain = grain_[a];
    const double since = time - grain.t;
    fly(grain.r, grain.v, since, has_gravity ? system_.gravity : 0);
    grain.t = time;
    const Vec3 n{0, 0, is_high ? -1.0 : 1.0};
    Vec3 u = grain.v;
    PlateSolver::Motion plate;
    if constexpr (plates == Plates::vibrating) plate = plate_solver_.plate_motion(time);
    const double speed = plate.velocity;
    const double gap = is_high ? plate_solver_.height - 0.5 - grain.r.z + plate.shift
                               : grain.r.z - 0.5 - plate.shift;
    if (-gap > tile.ledger.deepest_plate.depth) {
        tile.ledger.deepest_plate = {-gap, plan_[a].id, -1, time};
    }
    u.z -= speed;
    if constexpr (has_spin) u -= 0.5 * cross(plan_[a].spin, n);
    const double e = restitution_of(system_.plate, tile, i, i, time);
    Impulse impulse = impulse_of<tangential>(n, u, 1, e, system_.plate);
    if (!last_contact_.empty()) {
        const double least = plate_solver_.least_rebound(is_high);
        tile.ledger.resting += raise_rebound(impulse, n, n.z * u.z, 1, least);
    }
    if (impulse.normal > 0) {
        grain.v += impulse.j;
        if constexpr (has_spin) plan_[a].spin += spin_change(n, impulse.j);
        tile.ledger.plate_loss.add(impulse.loss);
        tile.ledger.work.add(impulse.j.z * speed);
        (is_high ? tile.ledger.high_impulse : tile.ledger.low_impulse).add(impulse.normal);
        tile.ledger.sliding += impulse.slides;
    }
    ++(is_high ? tile.ledger.high_plate : tile.ledger.low_plate);
    count_event(i, partner, time, since);
    predict(i, time);
    schedule(tile, i);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::collide_wall(Tile& tile, std::int32_t i) {
    const auto a = static_cast<std::size_t>(i);
    const double time = plan_[a].collision;
    Grain& grain = grain_[a];
    const double since = time - grain.t;
    fly(grain.r, grain.v, since, has_gravity ? system_.gravity : 0);
    grain.t = time;
    Vec3 n{};
    double gap = 0;
    const std::int32_t partner = plan_[a].partner;
    switch (partner) {
        case wall_x_low:
            n.x = 1;
            gap = grain.r.x - 0.5;
            break;
        case wall_x_high:
            n.x = -1;
            gap = cells_.length[0] - 0.5 - grain.r.x;
            break;
        case wall_y_low:
            n.y = 1;
            gap = grain.r.y - 0.5;
            break;
        default:
            n.y = -1;
            gap = cells_.length[1] - 0.5 - grain.r.y;
    }
    if (-gap > tile.ledger.deepest_plate.depth) {
        tile.ledger.deepest_plate = {-gap, plan_[a].id, -1, time};
    }
    Vec3 u = grain.v;
    if constexpr (plates == Plates::vibrating) u.z -= plate_solver_.plate_velocity(time);
    const double speed = grain.v.z - u.z;
    if constexpr (has_spin) u -= 0.5 * cross(plan_[a].spin, n);
    const double e = restitution_of(system_.plate, tile, i, i, time);
    const Impulse impulse = impulse_of<tangential>(n, u, 1, e, system_.plate);
    if (impulse.normal > 0) {
        grain.v += impulse.j;
        if constexpr (has_spin) plan_[a].spin += spin_change(n, impulse.j);
        tile.ledger.plate_loss.add(impulse.loss);
        tile.ledger.work.add(impulse.j.z * speed);
        tile.ledger.sliding += impulse.slides;
    }
    ++tile.ledger.wall;
    count_event(i, partner, time, since);
    predict(i, time);
    schedule(tile, i);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::cross_cell(Tile& tile, std::int32_t i) {
    const auto a = static_cast<std::size_t>(i);
    Plan& plan = plan_[a];
    const auto axis = static_cast<std::size_t>(plan.axis);
    const int there = plan.cell[axis] + plan.direction;
    ++tile.ledger.crossing;
    unlink(i);
    if (there >= 0 && there < cells_.count[axis]) {
        plan.cell[axis] = static_cast<std::uint16_t>(there);
        link(i);
        std::array<int, 3> low{plan.cell[0] - 1, plan.cell[1] - 1, plan.cell[2] - 1};
        std::array<int, 3> high{plan.cell[0] + 1, plan.cell[1] + 1, plan.cell[2] + 1};
        (plan.direction > 0 ? low : high)[axis] = there + plan.direction;
        consider_around(grain_[a], plan, low, high);
        consider_side_walls(grain_[a], plan);
        plan_crossing(grain_[a], plan, plan.crossing);
        schedule(tile, i);
        return;
    }
    // Through the side of the box: comes back on the other one, which is an event of its own
    // because the position changes.
    Grain& grain = grain_[a];
    const double time = plan.crossing;
    const double since = time - grain.t;
    fly(grain.r, grain.v, since, has_gravity ? system_.gravity : 0);
    grain.t = time;
    double& x = axis == 0 ? grain.r.x : (axis == 1 ? grain.r.y : grain.r.z);
    x = plan.direction > 0 ? 0 : cells_.length[axis];
    plan.cell[axis] = static_cast<std::uint16_t>(plan.direction > 0 ? 0 : cells_.count[axis] - 1);
    link(i);
    count_event(i, nothing, time, since);
    predict(i, time);
    schedule(tile, i);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::link(std::int32_t i) {
    const auto& cell = plan_[static_cast<std::size_t>(i)].cell;
    cells_.link(cells_.index(cell[0], cell[1], cell[2]), i, grain_);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::unlink(std::int32_t i) {
    const auto& cell = plan_[static_cast<std::size_t>(i)].cell;
    cells_.unlink(cells_.index(cell[0], cell[1], cell[2]), i, grain_);
}

template <Tangential tangential, bool has_gravity, Plates plates>
inline void EventEngine<tangential, has_gravity, plates>::count_event(std::int32_t i,
                                                                      std::int32_t partner,
                                                                      double time, double since) {
    if (++grain_[static_cast<std::size_t>(i)].events > unasked_events_)
        require_pace(i, partner, time);
    if (since < resolution_) count_burst(i, partner, time);
}

// Events without end in finite time: of a pair or of grain and plate, whose spacing shrinks
// geometrically. Whatever the ratio, it falls below the resolution of the clock and stays there.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::count_burst(std::int32_t i, std::int32_t partner,
                                                               double time) {
    constexpr std::uint32_t most = 1000;
    const double ticks = time / (most * resolution_);
    const auto tick = static_cast<std::uint32_t>(std::fmod(ticks, 0x1p32));
    Burst& burst = burst_[static_cast<std::size_t>(i)];
    if (burst.tick != tick) burst = {.tick = tick, .events = 0};
    if (++burst.events < most) return;
    report_collapse(i, partner,
                    fmt::format("{} events within {:.2g}, up to time {:.17g} of the window", most,
                                most * resolution_, time));
}

// At the present pace, a grain would have more events than are permitted in the window.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::require_pace(std::int32_t i,
                                                                std::int32_t partner,
                                                                double time) const {
    const double share = free_share + (end_ > 0 ? 2 * time / end_ : 1);
    const std::uint32_t events = grain_[static_cast<std::size_t>(i)].events;
    if (events <= std::min(share, 1.0) * collapse_limit_) return;
    report_collapse(i, partner,
                    fmt::format("{} events by time {:.17g} of the window", events, time));
}

// The TC model: a collision soon after the last one of either partner is elastic.
template <Tangential tangential, bool has_gravity, Plates plates>
double EventEngine<tangential, has_gravity, plates>::restitution_of(const ContactLaw& law,
                                                                    Tile& tile, std::int32_t i,
                                                                    std::int32_t j, double time) {
    if (last_contact_.empty()) return law.restitution;
    double& last_i = last_contact_[static_cast<std::size_t>(i)];
    double& last_j = last_contact_[static_cast<std::size_t>(j)];
    const bool is_contact = time - std::max(last_i, last_j) < system_.contact_time;
    last_i = last_j = time;
    if (!is_contact) return law.restitution;
    ++tile.ledger.contact_time;
    return 1;
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::report_collapse(std::int32_t i,
                                                                   std::int32_t partner,
                                                                   const std::string& pace) const {
    std::string with = "a side wall";
    if (partner >= 0) {
        with = fmt::format("grain {}", plan_[static_cast<std::size_t>(partner)].id);
    } else if (partner == low_plate || partner == high_plate) {
        with = partner == low_plate ? "the low plate" : "the high plate";
    } else if (partner == nothing) {
        with = "its neighbours";
    }
    throw InelasticCollapse(
        {.problem = fmt::format("inelastic collapse: grain {} collides without end with {}",
                                plan_[static_cast<std::size_t>(i)].id, with),
         .actual = pace,
         .expected = {},
         .suggestion =
             system_.contact_time > 0
                 ? fmt::format("run.contact-time (TC model) is {:g}: make it longer, or raise "
                               "run.event-limit if a grain at rest may hop so often",
                               system_.contact_time)
                 : "set run.contact-time (TC model), e.g. 1e-4, or a larger restitution"});
}

}  // namespace grainfield::simulate
