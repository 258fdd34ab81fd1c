// EventEngine on several threads: strips of cell rows, without rollback and with the same result.
//
// Each core (strip) has a calendar for the whole window, which goes through it in short steps.
// In a step a core executes its own events in order of time while its rim becomes
// unknown: what lies beyond the strip can reach a grain no sooner than something of speed
// `front_speed_` could, directly or by way of grains that it reached before. A grain that may have
// been reached is *lost*: it stops where it is. When all cores are done, the lost grains between
// them, the seams, go through the step with everything around them known. The trajectory is that of
// one queue, because no event is ever executed before one that could influence it.
#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "simulate/md/engine/event_engine.h"

namespace grainfield::simulate {

// Rows that a strip must have for its core to survive a step, that it must have to be worth a
// thread (below, two threads are no faster than one, and far slower where other work wants the
// cores), and that seams must stay apart.
constexpr int least_rows = 40;
constexpr int worthwhile_rows = 64;
constexpr int seam_distance = 8;
// How far, in cells, an unknown grain may get in a step, so that 5 × 5 cells cover its reach.
constexpr double step_reach = 0.9;
// Rows at the edge of a strip in which the unknown beyond it may reach a grain within a step: one
// of contact, and step_reach for each of the two. Another for grains beside their cell.
constexpr int rim_rows = 4;
constexpr double speed_reserve = 1.3;

template <Tangential tangential, bool has_gravity, Plates plates>
int EventEngine<tangential, has_gravity, plates>::strip_count() const {
    return grain_.empty() ? 1 : strips();
}

template <Tangential tangential, bool has_gravity, Plates plates>
int EventEngine<tangential, has_gravity, plates>::strips() const {
    if (options_.tiles > 0) {
        return std::clamp(cells_.count[1] / least_rows, 1, options_.tiles);
    }
    return std::clamp(cells_.count[1] / worthwhile_rows, 1, std::max(options_.threads, 1));
}

template <Tangential tangential, bool has_gravity, Plates plates>
double EventEngine<tangential, has_gravity, plates>::greatest_speed(double time, Team& team) const {
    constexpr std::size_t chunk = 16384;
    const std::size_t count = grain_.size();
    const auto chunks = static_cast<std::int64_t>((count + chunk - 1) / chunk);
    std::vector<double> greatest(static_cast<std::size_t>(chunks), 0);
    team.for_each(chunks, [&](std::int64_t c) {
        const auto k = static_cast<std::size_t>(c);
        for (std::size_t i = k * chunk; i < std::min(count, (k + 1) * chunk); ++i) {
            Vec3 v = grain_[i].v;
            if constexpr (has_gravity) v.z -= system_.gravity * (time - grain_[i].t);
            greatest[k] = std::max(greatest[k], squared_norm(v));
        }
    });
    double speed = 0;
    for (const double g : greatest) speed = std::max(speed, g);
    return std::sqrt(speed);
}

// Where strips do not get through, the window is done again with one queue: a grain was faster than
// the front; or something failed, and which failure is the first does not depend on the strips.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::advance_strips_or_whole(double time,
                                                                           Team& team) {
    try {
        if (advance_strips(time, team)) return;
    } catch (const PhysicsError&) {
        // What is thrown comes from the one queue.
    }
    ++fallbacks_;
    begin_window(team);
    start_whole(0);
    run(tile_.front(), time);
}

// Whether no grain was faster than the front.
template <Tangential tangential, bool has_gravity, Plates plates>
bool EventEngine<tangential, has_gravity, plates>::advance_strips(double time, Team& team) {
    const int strips = strip_count();
    if (!has_cores_) begin_cores(strips, team);
    const double width = *std::min_element(cells_.width.begin(), cells_.width.begin() + 2);
    double start = now_;
    while (start < time) {
        const double fastest = std::max(greatest_speed(start, team), plate_solver_.speed_bound);
        const double speed = speed_reserve * std::max(fastest, 1e-3);
        double step = step_reach * width / speed;
        front_margin_ = has_gravity ? system_.gravity * step : 0;
        front_speed_ = speed + front_margin_;
        step = step_reach * width / front_speed_;
        const double end = std::min(time, start + step);
        front_start_ = start;
        team.for_each(strips, [&](std::int64_t s) {
            run_core(tile_[static_cast<std::size_t>(s)], start, end);
        });
        if (!run_seams(start, end, strips, team)) return false;
        start = end;
    }
    return true;
}

// f(grain) for all grains in these rows of cells.
template <Tangential tangential, bool has_gravity, Plates plates>
template <class F>
void EventEngine<tangential, has_gravity, plates>::for_each_grain(int first_row, int end_row,
                                                                  F&& f) const {
    for (int z = 0; z < cells_.count[2]; ++z) {
        for (int y = first_row; y < end_row; ++y) {
            const std::size_t first = cells_.index(0, y, z);
            const std::size_t last = first + static_cast<std::size_t>(cells_.count[0]);
            for (std::size_t c = first; c < last; ++c) cells_.for_each(c, grain_, f);
        }
    }
}

// All events from now to the end of the window into the calendars of the cores.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::begin_cores(int strips, Team& team) {
    const std::size_t count = grain_.size();
    tile_.resize(2 * static_cast<std::size_t>(strips));
    owner_.resize(count);
    lost_at_.resize(count, never);
    loses_at_.resize(count, never);
    for (int s = 0; s < strips; ++s) {
        Tile& tile = tile_[static_cast<std::size_t>(s)];
        tile.kind = TileKind::core;
        tile.number = static_cast<Owner>(s);
        tile.first_row = s * cells_.count[1] / strips;
        tile.end_row = (s + 1) * cells_.count[1] / strips;
    }
    team.for_each(strips, [&](std::int64_t s) {
        Tile& tile = tile_[static_cast<std::size_t>(s)];
        reset_calendar(tile, now_, end_, count / static_cast<std::size_t>(strips));
        for_each_grain(tile.first_row, tile.end_row, [&](std::int32_t i) {
            const Plan& plan = plan_[static_cast<std::size_t>(i)];
            set_owner(i, tile.number);
            if (plan.time() < tile.end) tile.calendar.push({plan.time(), plan.id, i});
        });
    });
    has_cores_ = true;
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::run_core(Tile& tile, double start, double end) {
    tile.now = start;
    tile.step_end = end;
    tile.low_front = tile.first_row;
    tile.high_front = tile.end_row - 1;
    tile.is_violated = false;
    tile.unknown.clear();
    const auto threaten_rim = [&](std::int32_t i) {
        const double t = time_lost(tile, i);
        if (t <= start) {
            lose(tile, i);
        } else if (t < end) {
            threaten(tile, i, t);
        }
    };
    for_each_grain(tile.first_row, tile.first_row + rim_rows, threaten_rim);
    for_each_grain(tile.end_row - rim_rows, tile.end_row, threaten_rim);
    // Whatever is threatened now is lost, or has had another event, before the step ends.
    run(tile, end);
}

// Plans the next event of a grain of a core, and when it is lost if that comes first.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::plan_in_core(Tile& tile, std::int32_t i) {
    const auto k = static_cast<std::size_t>(i);
    set_owner(i, tile.number);
    const Plan& plan = plan_[k];
    if (plan.time() < tile.end) tile.calendar.push({plan.time(), plan.id, i});
    if (const double t = time_lost(tile, i); t < tile.step_end) threaten(tile, i, t);
}

// The unknown will reach the grain at `time`, within the step.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::threaten(Tile& tile, std::int32_t i,
                                                            double time) {
    const auto k = static_cast<std::size_t>(i);
    set_owner(i, tile.number | threatened_mark);
    loses_at_[k] = time;
    const Plan& plan = plan_[k];
    if (time < plan.time()) tile.calendar.push({time, plan.id, i});
}

template <Tangential tangential, bool has_gravity, Plates plates>
bool EventEngine<tangential, has_gravity, plates>::run_seams(double start, double end, int strips,
                                                             Team& team) {
    const auto n = static_cast<std::size_t>(strips);
    bool is_good = true;
    bool is_apart = true;
    for (std::size_t s = 0; s < n; ++s) {
        is_good = is_good && !tile_[s].is_violated;
        is_apart = is_apart && tile_[s].low_front + seam_distance < tile_[s].high_front;
    }
    if (!is_good) return false;
    for (std::size_t s = 0; s < n; ++s) {
        Tile& seam = tile_[n + s];
        seam.kind = TileKind::seam;
        seam.is_violated = false;
        seam.now = start;
        seam.unknown.clear();
    }
    for (std::size_t s = 0; s < n; ++s) {
        const int middle = (tile_[s].low_front + tile_[s].high_front) / 2;
        for (const std::int32_t i : tile_[s].unknown) {
            const bool is_low = plan_[static_cast<std::size_t>(i)].cell[1] <= middle;
            const std::size_t seam = !is_apart ? 0 : (is_low ? s : (s + 1) % n);
            tile_[n + seam].unknown.push_back(i);
        }
    }
    team.for_each(is_apart ? strips : 1,
                  [&](std::int64_t s) { run_seam(tile_[n + static_cast<std::size_t>(s)], end); });
    for (std::size_t s = 0; s < n; ++s) is_good = is_good && !tile_[n + s].is_violated;
    team.for_each(strips,
                  [&](std::int64_t s) { take_back(tile_[static_cast<std::size_t>(s)], strips); });
    return is_good;
}

// The lost grains that are in the rows of this core after the step are its own from now on.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::take_back(Tile& core, int strips) {
    for (int s = strips; s < 2 * strips; ++s) {
        for (const std::int32_t i : tile_[static_cast<std::size_t>(s)].unknown) {
            const auto k = static_cast<std::size_t>(i);
            const Plan& plan = plan_[k];
            if (plan.cell[1] < core.first_row || plan.cell[1] >= core.end_row) continue;
            set_owner(i, core.number);
            if (plan.time() < core.end) core.calendar.push({plan.time(), plan.id, i});
        }
    }
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::run_seam(Tile& tile, double end) {
    reset_calendar(tile, tile.now, end, tile.unknown.size());
    for (const std::int32_t i : tile.unknown) {
        predict(i, lost_at_[static_cast<std::size_t>(i)]);
        schedule(tile, i);
    }
    tile.is_violated = false;
    run(tile, end);
}

// From now on grain i may be anywhere that the front speed allows.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::lose(Tile& tile, std::int32_t i) {
    lost_at_[static_cast<std::size_t>(i)] = tile.now;
    set_owner(i, tile.number | lost_mark);
    tile.unknown.push_back(i);
    const int row = plan_[static_cast<std::size_t>(i)].cell[1];
    if (2 * row < tile.first_row + tile.end_row) {
        tile.low_front = std::max(tile.low_front, row);
    } else {
        tile.high_front = std::min(tile.high_front, row);
    }
    loses_neighbours(tile, i);
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::loses_neighbours(Tile& tile, std::int32_t i) {
    const auto& cell = plan_[static_cast<std::size_t>(i)].cell;
    const std::array<int, 3> low{cell[0] - 2, std::max(cell[1] - 2, tile.first_row), cell[2] - 2};
    const std::array<int, 3> high{cell[0] + 2, std::min(cell[1] + 2, tile.end_row - 1),
                                  cell[2] + 2};
    for_each_image(low, high, [&](std::int32_t j, const Vec3&) {
        if (!is_known(j)) return;
        const auto k = static_cast<std::size_t>(j);
        const double t = time_reached(j, i, tile.now);
        if (t >= ((owner_of(j) & threatened_mark) != 0 ? loses_at_[k] : tile.step_end)) return;
        threaten(tile, j, t);
    });
}

// When the unknown reaches grain i, as things stand: from the edges of the strip or from grains
// lost already.
template <Tangential tangential, bool has_gravity, Plates plates>
double EventEngine<tangential, has_gravity, plates>::time_lost(const Tile& tile,
                                                               std::int32_t i) const {
    const Grain& grain = grain_[static_cast<std::size_t>(i)];
    const Plan& plan = plan_[static_cast<std::size_t>(i)];
    const double now = std::max(tile.now, grain.t);
    const double width = cells_.width[1];
    const double y = grain.r.y + grain.v.y * (now - grain.t);
    const double reached = width * (1 + 1e-6) + front_speed_ * (now - front_start_);
    double lost = never;
    const auto edge = [&](double distance, double approach) {
        const double rest = distance - reached;
        const double closing = front_speed_ + approach;
        const double t = rest <= 0 ? now : now + 0.999999 * rest / std::max(closing, 1e-300);
        lost = std::min(lost, t);
    };
    const int row = plan.cell[1];
    if (row < tile.first_row + rim_rows && (cells_.periodic[1] || tile.first_row > 0)) {
        edge(y - tile.first_row * width, -grain.v.y);
    }
    if (row >= tile.end_row - rim_rows && (cells_.periodic[1] || tile.end_row < cells_.count[1])) {
        edge(tile.end_row * width - y, grain.v.y);
    }
    if (tile.unknown.empty() || (row > tile.low_front + 2 && row < tile.high_front - 2)) {
        return lost;
    }
    const std::array<int, 3> low{plan.cell[0] - 2, std::max(row - 2, tile.first_row),
                                 plan.cell[2] - 2};
    const std::array<int, 3> high{plan.cell[0] + 2, std::min(row + 2, tile.end_row - 1),
                                  plan.cell[2] + 2};
    for_each_image(low, high, [&](std::int32_t j, const Vec3&) {
        if (!is_known(j)) lost = std::min(lost, time_reached(i, j, now));
    });
    return lost;
}

// When the sphere of reach of a lost grain, growing with the front speed, touches grain i:
// |d + v τ| = R + (V + ½ g Δ) τ, Δ the step.
template <Tangential tangential, bool has_gravity, Plates plates>
double EventEngine<tangential, has_gravity, plates>::time_reached(std::int32_t i, std::int32_t lost,
                                                                  double now) const {
    const Grain& g1 = grain_[static_cast<std::size_t>(i)];
    const Grain& g2 = grain_[static_cast<std::size_t>(lost)];
    const double since = lost_at_[static_cast<std::size_t>(lost)];
    const double g = has_gravity ? system_.gravity : 0;
    Vec3 r1 = g1.r;
    Vec3 v1 = g1.v;
    fly(r1, v1, now - g1.t, g);
    Vec3 r2 = g2.r;
    Vec3 v2 = g2.v;
    fly(r2, v2, since - g2.t, g);
    Vec3 d = r1 - r2;
    const auto nearest = [](double x, double length) {
        return x > 0.5 * length ? x - length : (x < -0.5 * length ? x + length : x);
    };
    if (cells_.periodic[0]) d.x = nearest(d.x, cells_.length[0]);
    if (cells_.periodic[2]) d.z = nearest(d.z, cells_.length[2]);
    const double radius = 1 + 1e-6 + front_speed_ * (now - since);
    const double f = squared_norm(d) - radius * radius;
    if (f <= 0) return now;
    // Within a step, ½ g τ² of the grain's own fall is less than half the margin times τ.
    const double closing = front_speed_ + 0.5 * front_margin_;
    const double a = squared_norm(v1) - closing * closing;
    const double b = dot(d, v1) - radius * closing;
    if (a >= 0) return now;  // faster than the front; the step is done again anyway
    const double root = std::sqrt(b * b - a * f);
    const double tau = b < 0 ? f / (root - b) : -(b + root) / a;
    return now + 0.999999 * tau;
}

}  // namespace grainfield::simulate
