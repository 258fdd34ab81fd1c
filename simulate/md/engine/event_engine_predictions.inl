// How EventEngine finds the next event of a grain.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "simulate/md/engine/event_engine.h"

namespace grainfield::simulate {

/// Collects candidates cell by cell. First their indices are read, then their contact times are
/// computed. So all their cache lines are fetched at once. Of cells with three grains or less,
/// which are nearly all, no branch depends on their number.
template <Tangential tangential, bool has_gravity, Plates plates>
class EventEngine<tangential, has_gravity, plates>::Nearby {
 public:
    Nearby(const EventEngine& engine, const Grain& grain, Plan& plan)
        : engine_(engine), grain_(grain), plan_(plan) {}

    /// The grains of a cell. Not mixed with images before plan_first().
    void add(std::size_t cell) {
        assert(!near_.is_shifted);
        add_members(cell, [](std::size_t, std::size_t) {});
    }

    /// The periodic images of the grains of a cell, `shift` away from the grains.
    void add(std::size_t cell, const Vec3& shift) {
        if (is_full()) plan_first();
        add_members(cell, [this, &shift](std::size_t from, std::size_t count) {
            near_.is_shifted = true;
            for (std::size_t k = from; k < from + count; ++k) {
                near_.shift_x[k] = shift.x;
                near_.shift_y[k] = shift.y;
                near_.shift_z[k] = shift.z;
            }
        });
    }

    /// A block of cells inside the grid, at most three in x, the first of them at `corner`.
    void add_block(std::size_t corner, int nx, int ny, int nz) {
        assert(nx <= 3);
        const auto row = static_cast<std::size_t>(engine_.cells_.count[0]);
        const std::size_t plane = row * static_cast<std::size_t>(engine_.cells_.count[1]);
        for (int z = 0; z < nz; ++z, corner += plane) {
            std::size_t first = corner;
            for (int y = 0; y < ny; ++y, first += row) {
                for (int x = 0; x < nx; ++x) add(first + static_cast<std::size_t>(x));
                if (is_full()) plan_first();
            }
        }
    }

    /// Plans the first contact with what was collected, if it comes before what is planned; forgets
    /// what was collected.
    void plan_first() {
        const HugeVector<Grain>& grains = engine_.grain_;
        const Contact contact =
            engine_.search_(grain_, grains.data(), engine_.system_.gravity, plan_.collision, near_);
        if (contact.partner >= 0) {
            plan_.collision = contact.time;
            plan_.partner = contact.partner;
            plan_.partner_events = grains[static_cast<std::size_t>(contact.partner)].events;
        }
        near_.count = 0;
        near_.is_shifted = false;
    }

 private:
    static constexpr std::size_t three_cells = 3 * CellGrid::most_in_cell;
    static_assert(2 * three_cells <= Candidates::room);
    static_assert(Cell::places <= Candidates::spare);

    bool is_full() const { return near_.count + three_cells > Candidates::room; }

    // Adds the grains of a cell. mark(first, count) writes the shifts of `count` candidates from
    // the first one on. Where plates throw a whole column of grains above the highest cells, a cell
    // may hold any number. When there is no room, those that are there are planned for.
    template <class Mark>
    void add_members(std::size_t cell, Mark&& mark) {
        const CellGrid& cells = engine_.cells_;
        const auto count = static_cast<std::size_t>(cells.cell[cell].count);
        constexpr auto places = static_cast<std::size_t>(Cell::places);
        if (count <= static_cast<std::size_t>(CellGrid::most_in_cell)) {
            cells.copy(cell, engine_.grain_, &near_.id[near_.count]);
            mark(near_.count, places);  // a fixed number, whether there are as many or not
            if (count > places) mark(near_.count + places, count - places);
            near_.count += count;
            return;
        }
        cells.for_each(cell, engine_.grain_, [&](std::int32_t j) {
            if (is_full()) plan_first();
            mark(near_.count, 1);
            near_.id[near_.count++] = j;
        });
    }

    const EventEngine& engine_;
    const Grain& grain_;
    Plan& plan_;
    Candidates near_;
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
        Nearby nearby(*this, grain, plan);
        if (cells_.count[2] > 1) {
            nearby.add_block(cells_.index(x - 1, y - 1, z - 1), 3, 3, 3);
        } else {
            nearby.add_block(cells_.index(x - 1, y - 1, z), 3, 3, 1);
        }
        nearby.plan_first();
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

template <Tangential tangential, bool has_gravity, Plates plates>
void EventEngine<tangential, has_gravity, plates>::consider_around(
    const Grain& grain, Plan& plan, const std::array<int, 3>& low,
    const std::array<int, 3>& high) const {
    Nearby nearby(*this, grain, plan);
    std::array<int, 3> first = low;
    std::array<int, 3> last = high;
    bool wraps = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!cells_.periodic[axis]) {
            first[axis] = std::max(first[axis], 0);
            last[axis] = std::min(last[axis], cells_.count[axis] - 1);
        }
        wraps = wraps || first[axis] < 0 || last[axis] >= cells_.count[axis];
    }
    if (wraps) {
        for_each_cell(low, high,
                      [&](std::size_t cell, const Vec3& shift) { nearby.add(cell, shift); });
    } else {
        nearby.add_block(cells_.index(first[0], first[1], first[2]), last[0] - first[0] + 1,
                         last[1] - first[1] + 1, last[2] - first[2] + 1);
    }
    nearby.plan_first();
}

// f(cell, shift) for the cells low … high, wrapped around periodic axes with the shift of the
// image, cut at walls.
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
    // Table entries and sums in place of branches: where a grain goes next cannot be foreseen.
    const std::array<double, 3> speed{grain.v.x, grain.v.y, grain.v.z};
    std::array<double, 3> tau{never, never, never};
    const auto time_to_edge = [&](std::size_t axis, double x) {
        const double v = speed[axis];
        const auto next = static_cast<std::size_t>(plan.cell[axis] + (v > 0));
        if (v != 0) tau[axis] = (cells_.edge[axis][next] - x) / v;
    };
    time_to_edge(0, grain.r.x);
    time_to_edge(1, grain.r.y);
    std::int8_t vertical = 0;  // direction under gravity
    if constexpr (has_gravity) {
        if (cells_.count[2] > 1) tau[2] = vertical_crossing(grain, plan, now, vertical);
    } else {
        if (cells_.count[2] > 1 || cells_.periodic[2]) time_to_edge(2, grain.r.z);
    }
    std::size_t axis = tau[1] < tau[0];
    axis += (2 - axis) * static_cast<std::size_t>(tau[2] < tau[axis]);
    plan.axis = static_cast<std::int8_t>(axis);
    plan.direction = static_cast<std::int8_t>(2 * (speed[axis] > 0) - 1);
    if constexpr (has_gravity) {
        if (axis == 2) plan.direction = vertical;
    }
    const double best = tau[axis];
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
