// How EventEngine finds the next event of a grain.
#include <algorithm>
#include <cmath>

#include "simulate/md/engine/event_engine.h"

namespace grainfield::simulate {

/// Grains to be tested. First their numbers are read, then their contact times are computed. So all
/// their cache lines are fetched at once, and no branch depends on the number of grains of a cell.
template <Tangential tangential, bool has_gravity, Plates plates>
struct EventEngine<tangential, has_gravity, plates>::Nearby {
    static constexpr std::size_t three_cells = 3 * CellGrid::most_in_cell;
    static constexpr std::size_t room = 2 * three_cells;
    std::array<std::int32_t, room + pair_filter_room> id;
    std::size_t count = 0;

    bool is_full() const { return count + three_cells > room; }
    /// Adds the grains of a cell. Where plates throw a whole column of grains above the highest
    /// cells, one may hold any number: `test` tests and forgets what is there when there is no
    /// room.
    template <class Test>
    void add(const CellGrid& cells, std::size_t cell, const HugeVector<Grain>& grains,
             Test&& test) {
        if (cells.cell[cell].count <= CellGrid::most_in_cell) {
            count += cells.copy(cell, grains, &id[count]);
            return;
        }
        cells.for_each(cell, grains, [&](std::int32_t j) {
            if (is_full()) test();
            id[count++] = j;
        });
    }
};

// `now`, not the time of the grain's own last event, gives the direction in which it crosses its
// cell.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::predict(std::int32_t i, double now) {
    Plan& plan = plan_[static_cast<std::size_t>(i)];
    const Grain& grain = grain_[static_cast<std::size_t>(i)];
    plan.collision = end_;
    plan.partner = nothing;
    const int x = plan.cell[0];
    const int y = plan.cell[1];
    const int z = plan.cell[2];
    if (cells_.is_inside(x, y, z)) {
        const std::size_t centre = cells_.index(x, y, z);
        const auto row = static_cast<std::size_t>(cells_.count[0]);
        const std::size_t plane = row * static_cast<std::size_t>(cells_.count[1]);
        const bool deep = cells_.count[2] > 1;
        const std::size_t low = deep ? centre - plane : centre;
        const std::size_t high = deep ? centre + plane : centre;
        Nearby nearby;
        const auto test = [&] { consider(grain, plan, nearby, {}); };
        for (std::size_t p = low; p <= high; p += plane) {
            for (std::size_t q = p - row; q <= p + row; q += row) {
                for (std::size_t c = q - 1; c <= q + 1; ++c) nearby.add(cells_, c, grain_, test);
                if (nearby.is_full()) test();
            }
        }
        test();
    } else {
        consider_around(grain, plan, {x - 1, y - 1, z - 1}, {x + 1, y + 1, z + 1});
        consider_side_walls(grain, plan);
    }
    if constexpr (plates != Plates::none) {
        const auto hit =
            plate_solver_.template first_hit<plates, has_gravity>(grain, plan.collision);
        if (hit.time < plan.collision) {
            plan.collision = hit.time;
            plan.partner = hit.high ? high_plate : low_plate;
        }
    }
    plan_crossing(grain, plan, now);
}

// Tests the grains collected so far, and forgets them.
template <Tangential tangential, bool has_gravity, Plates plates>
inline void EventEngine<tangential, has_gravity, plates>::consider(const Grain& grain, Plan& plan,
                                                                   Nearby& nearby,
                                                                   const Vec3& shift) const {
    std::int32_t* const id = nearby.id.data();
    const double g = system_.gravity;
    const std::size_t count =
        touching_(grain, grain_.data(), shift, g, plan.collision, id, nearby.count);
    for (std::size_t k = 0; k < count; ++k) {
        const Grain& other = grain_[static_cast<std::size_t>(id[k])];
        const double t = pair_time<has_gravity>(grain, other, shift, g, plan.collision);
        if (t < plan.collision) {
            plan.collision = t;
            plan.partner = id[k];
            plan.partner_events = other.events;
        }
    }
    nearby.count = 0;
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::consider_around(
    const Grain& grain, Plan& plan, const std::array<int, 3>& low,
    const std::array<int, 3>& high) const {
    Nearby nearby;
    Vec3 shift;
    const auto test = [&] { consider(grain, plan, nearby, shift); };
    for_each_cell(low, high, [&](std::size_t cell, const Vec3& of_cell) {
        if (nearby.is_full() || !(of_cell == shift)) test();
        shift = of_cell;
        nearby.add(cells_, cell, grain_, test);
    });
    test();
}

// f(cell, shift) for the cells low … high, wrapped around periodic axes with the shift of the
// image, cut at walls. Cells of one shift come together: their grains are tested in one go.
template <Tangential tangential, bool has_gravity, Plates plates>
template <class F>
void EventEngine<tangential, has_gravity, plates>::for_each_cell(const std::array<int, 3>& low,
                                                                 const std::array<int, 3>& high,
                                                                 F&& f) const {
    struct Run {
        int first, last;
        double shift;
    };
    const auto runs = [this, &low, &high](std::size_t axis, std::array<Run, 3>& run) {
        std::size_t count = 0;
        const int n = cells_.count[axis];
        const double length = cells_.length[axis];
        const bool wraps = cells_.periodic[axis];
        const auto add = [&](int first, int last, int from, double shift) {
            if (first <= last) run[count++] = {first - from, last - from, shift};
        };
        if (wraps) add(low[axis], std::min(high[axis], -1), -n, -length);
        add(std::max(low[axis], 0), std::min(high[axis], n - 1), 0, 0);
        if (wraps) add(std::max(low[axis], n), high[axis], n, length);
        return count;
    };
    std::array<Run, 3> xs;
    std::array<Run, 3> ys;
    std::array<Run, 3> zs;
    const std::size_t nx = runs(0, xs);
    const std::size_t ny = runs(1, ys);
    const std::size_t nz = runs(2, zs);
    const auto visit = [this, &f](const Run& x, const Run& y, const Run& z) {
        const Vec3 shift{x.shift, y.shift, z.shift};
        for (int k = z.first; k <= z.last; ++k) {
            for (int j = y.first; j <= y.last; ++j) {
                const std::size_t last = cells_.index(x.last, j, k);
                for (std::size_t c = cells_.index(x.first, j, k); c <= last; ++c) f(c, shift);
            }
        }
    };
    for (std::size_t c = 0; c < nz; ++c) {
        for (std::size_t b = 0; b < ny; ++b) {
            for (std::size_t a = 0; a < nx; ++a) visit(xs[a], ys[b], zs[c]);
        }
    }
}

// f(grain, shift) for all grains in these cells.
template <Tangential tangential, bool has_gravity, Plates plates>
template <class F>
void EventEngine<tangential, has_gravity, plates>::for_each_image(const std::array<int, 3>& low,
                                                                  const std::array<int, 3>& high,
                                                                  F&& f) const {
    for_each_cell(low, high, [&](std::size_t cell, const Vec3& shift) {
        cells_.for_each(cell, grain_, [&](std::int32_t j) { f(j, shift); });
    });
}

// Only grains in cells at a wall can meet it before they leave their cell.
template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::consider_side_walls(const Grain& grain,
                                                                       Plan& plan) const {
    const auto consider = [&plan, &grain](double gap, double speed, std::int32_t wall) {
        if (!(speed > 0)) return;
        const double t = grain.t + (gap > 0 ? gap / speed : 0);
        if (t < plan.collision) {
            plan.collision = t;
            plan.partner = wall;
        }
    };
    if (system_.walls_x) {
        if (plan.cell[0] == 0) consider(grain.r.x - 0.5, -grain.v.x, wall_x_low);
        if (plan.cell[0] + 1 == cells_.count[0]) {
            consider(cells_.length[0] - 0.5 - grain.r.x, grain.v.x, wall_x_high);
        }
    }
    if (system_.walls_y) {
        if (plan.cell[1] == 0) consider(grain.r.y - 0.5, -grain.v.y, wall_y_low);
        if (plan.cell[1] + 1 == cells_.count[1]) {
            consider(cells_.length[1] - 0.5 - grain.r.y, grain.v.y, wall_y_high);
        }
    }
}

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::plan_crossing(const Grain& grain, Plan& plan,
                                                                 double now) const {
    double best = never;
    const auto consider = [&](std::int8_t axis, double x, double v) {
        const auto a = static_cast<std::size_t>(axis);
        if (v == 0) return;
        const bool up = v > 0;
        if (!cells_.periodic[a] && (up ? plan.cell[a] + 1 == cells_.count[a] : plan.cell[a] == 0)) {
            return;
        }
        // The last edge is the box's own, without rounding.
        const double edge = up && plan.cell[a] + 1 == cells_.count[a]
                                ? cells_.length[a]
                                : (plan.cell[a] + (up ? 1 : 0)) * cells_.width[a];
        const double tau = (edge - x) / v;
        if (tau < best) {
            best = tau;
            plan.axis = axis;
            plan.direction = up ? 1 : -1;
        }
    };
    consider(0, grain.r.x, grain.v.x);
    consider(1, grain.r.y, grain.v.y);
    if (cells_.count[2] > 1) {
        if constexpr (has_gravity) {
            std::int8_t direction = 0;
            const double tau = vertical_crossing(grain, plan, now, direction);
            if (tau < best) {
                best = tau;
                plan.axis = 2;
                plan.direction = direction;
            }
        } else {
            consider(2, grain.r.z, grain.v.z);
        }
    } else if (cells_.periodic[2]) {
        consider(2, grain.r.z, grain.v.z);
    }
    plan.crossing = std::max(grain.t + best, now);
}

// Time after which a parabola leaves the cell's layer. The grain's own state may be older than its
// entry into this cell, at `now`: what lies before does not count.
template <Tangential tangential, bool has_gravity, Plates plates>
double EventEngine<tangential, has_gravity, plates>::vertical_crossing(
    const Grain& grain, const Plan& plan, double now, std::int8_t& direction) const {
    const double g = system_.gravity;
    const double v = grain.v.z;
    const bool rises = v - g * (now - grain.t) > 0;
    if (rises && plan.cell[2] + 1 < cells_.count[2]) {
        const double up = std::max((plan.cell[2] + 1) * cells_.width[2] - grain.r.z, 0.0);
        const double d = v * v - 2 * g * up;
        if (d >= 0) {
            direction = 1;
            return 2 * up / (v + std::sqrt(d));
        }
    }
    if (plan.cell[2] == 0) return never;
    direction = -1;
    const double down = grain.r.z - plan.cell[2] * cells_.width[2];
    const double root = std::sqrt(std::max(v * v + 2 * g * down, 0.0));
    return v < 0 ? std::max(2 * down / (root - v), 0.0) : (v + root) / g;
}

// Deepest overlap of grain i with what is around it; all grains are at the same time.
template <Tangential tangential, bool has_gravity, Plates plates>
double EventEngine<tangential, has_gravity, plates>::overlap_of(std::size_t i) const {
    const Vec3& r = grain_[i].r;
    const auto& cell = plan_[i].cell;
    double least = 1;
    const auto compare = [&](std::int32_t j, const Vec3& shift) {
        if (static_cast<std::size_t>(j) <= i) return;
        const Vec3 d = grain_[static_cast<std::size_t>(j)].r + shift - r;
        least = std::min(least, squared_norm(d));
    };
    const std::array<int, 3> low{cell[0] - 1, cell[1] - 1, cell[2] - 1};
    const std::array<int, 3> high{cell[0] + 1, cell[1] + 1, cell[2] + 1};
    for_each_image(low, high, compare);
    double overlap = 1 - std::sqrt(least);
    if constexpr (plates != Plates::none) {
        overlap = std::max({overlap, 0.5 - r.z, r.z + 0.5 - plate_solver_.height});
    }
    if (system_.walls_x) overlap = std::max({overlap, 0.5 - r.x, r.x + 0.5 - cells_.length[0]});
    if (system_.walls_y) overlap = std::max({overlap, 0.5 - r.y, r.y + 0.5 - cells_.length[1]});
    return overlap;
}

}  // namespace grainfield::simulate
