#include "simulate/md/state/initial_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/random.h"
#include "simulate/md/engine/engine_choice.h"

namespace grainfield::simulate {

namespace {

constexpr double low_cell = 3;

struct Axis {
    double length;
    bool walls;

    int most_sites() const { return static_cast<int>(std::floor(length * (1 + 1e-12))); }
    double spacing(int sites) const {
        if (!walls) return length / sites;
        return sites > 1 ? (length - 1) / (sites - 1) : length;
    }
    double site(int k, int sites) const {
        return walls ? 0.5 + (sites > 1 ? k * spacing(sites) : 0.5 * (length - 1))
                     : (k + 0.5) * spacing(sites);
    }
};

[[noreturn]] void refuse(std::int64_t wanted, std::int64_t most, const std::string& remedy) {
    throw OptionError({.problem = "cell.grains: so many grains do not fit",
                       .actual = std::to_string(wanted),
                       .expected = fmt::format("about {} at most in this layout", most),
                       .suggestion = remedy});
}

/// The places of the layout, and whether they form a lattice that must be melted.
struct Sites {
    std::vector<Vec3> place;
    bool is_lattice = false;
};

// `wanted` of the places, chosen at random, in their order.
std::vector<Vec3> choose(const std::vector<Vec3>& places, std::size_t wanted, std::uint64_t seed) {
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    RandomStream random(seed, "md sites");
    for (std::size_t i = 0; i < wanted; ++i) {
        std::swap(order[i], order[i + random.below(order.size() - i)]);
    }
    std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(wanted));
    std::vector<Vec3> chosen(wanted);
    for (std::size_t i = 0; i < wanted; ++i) chosen[i] = places[order[i]];
    return chosen;
}

std::vector<Vec3> single_sites(const Axis& x, const Axis& y, double height, std::uint64_t seed) {
    std::vector<Vec3> places;
    const int nx = x.most_sites();
    const int ny = y.most_sites();
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            RandomStream random(seed, "md heights", places.size());
            places.push_back({x.site(i, nx), y.site(j, ny), random.uniform(0.5, height - 0.5)});
        }
    }
    return places;
}

// Square lattice in projection, layers alternating: spacing² + δz² ≥ 1 and diagonal ≥ 1.
std::vector<Vec3> bilayer_sites(const Axis& x, const Axis& y, double height, std::size_t wanted) {
    const double gap = height - 1;
    const double least = std::max(std::sqrt(0.5), std::sqrt(std::max(0.0, 1 - gap * gap))) + 1e-9;
    const auto even = [](int n, bool walls) { return walls ? n : n - n % 2; };
    const auto most = [&](const Axis& axis) {
        const double span = axis.walls ? axis.length - 1 : axis.length;
        return even(static_cast<int>(span / least) + (axis.walls ? 1 : 0), axis.walls);
    };
    const int most_x = most(x);
    const int most_y = most(y);
    const auto capacity = static_cast<std::int64_t>(most_x) * most_y;
    if (capacity < static_cast<std::int64_t>(wanted)) {
        refuse(static_cast<std::int64_t>(wanted), capacity, "use fewer grains or a larger cell");
    }
    int nx = most_x;
    int ny = most_y;
    // As wide a lattice as holds them.
    while (true) {
        const bool x_tighter = x.spacing(nx) < y.spacing(ny);
        const int step_x = x.walls ? 1 : 2;
        const int step_y = y.walls ? 1 : 2;
        if (x_tighter &&
            static_cast<std::size_t>(nx - step_x) * static_cast<std::size_t>(ny) >= wanted) {
            nx -= step_x;
        } else if (static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny - step_y) >= wanted) {
            ny -= step_y;
        } else {
            break;
        }
    }
    std::vector<Vec3> places;
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            places.push_back({x.site(i, nx), y.site(j, ny), (i + j) % 2 == 0 ? 0.5 : height - 0.5});
        }
    }
    return places;
}

std::vector<Vec3> cubic_sites(const std::array<Axis, 3>& axes, std::size_t wanted) {
    const auto spacing = [](const Axis& axis, int n) {
        return axis.walls ? (axis.length - 1) / (n - 0.5) : axis.length / n;
    };
    double volume = 1;
    for (const Axis& axis : axes) volume *= axis.length;
    const double edge =
        std::cbrt(4 * volume / static_cast<double>(std::max<std::size_t>(wanted, 1)));
    std::array<int, 3> base{};
    for (std::size_t k = 0; k < 3; ++k) base[k] = static_cast<int>(axes[k].length / edge);
    std::array<int, 3> best{};
    double widest = 0;
    std::int64_t most = 0;
    for (int trial = 0; trial < 64; ++trial) {
        std::array<int, 3> n{base[0] + trial % 4, base[1] + trial / 4 % 4, base[2] + trial / 16};
        std::array<double, 3> c{};
        for (std::size_t k = 0; k < 3; ++k) {
            n[k] = std::max(n[k], 1);
            c[k] = spacing(axes[k], n[k]);
        }
        const double least = 0.5 * std::min({std::hypot(c[0], c[1]), std::hypot(c[1], c[2]),
                                             std::hypot(c[0], c[2]), 2 * c[0], 2 * c[1], 2 * c[2]});
        const auto count = std::int64_t{4} * n[0] * n[1] * n[2];
        if (least < 1) continue;
        most = std::max(most, count);
        if (count >= static_cast<std::int64_t>(wanted) && least > widest) {
            widest = least;
            best = n;
        }
    }
    if (widest == 0) {
        refuse(static_cast<std::int64_t>(wanted), most, "use fewer grains or a larger cell");
    }
    constexpr std::array<std::array<double, 3>, 4> basis{
        {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}}};
    std::vector<Vec3> places;
    const auto at = [&](std::size_t k, double cell) {
        const double c = spacing(axes[k], best[k]);
        return axes[k].walls ? 0.5 + cell * c : (cell + 0.25) * c;
    };
    for (int z = 0; z < best[2]; ++z) {
        for (int y = 0; y < best[1]; ++y) {
            for (int x = 0; x < best[0]; ++x) {
                for (const auto& b : basis) {
                    places.push_back({at(0, x + b[0]), at(1, y + b[1]), at(2, z + b[2])});
                }
            }
        }
    }
    return places;
}

std::vector<Vec3> patch_sites(const MdOptions& options, const Axis& x, const Axis& y,
                              std::uint64_t seed) {
    const double height = options.cell.height;
    const double s = options.initial.crystal_spacing;
    const double gap = height - 1;
    const auto wanted = static_cast<std::size_t>(options.cell.grains);
    if (s * s * 2 < 1 || s * s + gap * gap < 1) {
        throw OptionError({.problem = "initial.crystal-spacing: the layers of the patch overlap",
                           .actual = fmt::format("{:g}", s),
                           .expected = fmt::format(
                               "at least {:.4f} a in this cell",
                               std::max(std::sqrt(0.5), std::sqrt(std::max(0.0, 1 - gap * gap)))),
                           .suggestion = {}});
    }
    const double side = std::sqrt(options.initial.crystal_fraction);
    const int nx = static_cast<int>(side * (x.length - 2) / s);
    const int ny = static_cast<int>(side * (y.length - 2) / s);
    std::vector<Vec3> places;
    const Vec2 corner{0.5 * (x.length - (nx - 1) * s), 0.5 * (y.length - (ny - 1) * s)};
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            places.push_back(
                {corner.x + i * s, corner.y + j * s, (i + j) % 2 == 0 ? 0.5 : height - 0.5});
        }
    }
    const auto near_patch = [&](const Vec3& p) {
        return nx > 0 && ny > 0 && p.x > corner.x - 1 && p.x < corner.x + (nx - 1) * s + 1 &&
               p.y > corner.y - 1 && p.y < corner.y + (ny - 1) * s + 1;
    };
    std::vector<Vec3> liquid = single_sites(x, y, height, seed);
    std::erase_if(liquid, near_patch);
    if (places.size() > wanted || places.size() + liquid.size() < wanted) {
        refuse(static_cast<std::int64_t>(wanted),
               static_cast<std::int64_t>(places.size() + liquid.size()),
               fmt::format("the patch holds {} and the liquid 0 … {}: change "
                           "initial.crystal-fraction",
                           places.size(), liquid.size()));
    }
    const std::vector<Vec3> chosen = choose(liquid, wanted - places.size(), seed);
    places.insert(places.end(), chosen.begin(), chosen.end());
    return places;
}

Sites sites_for(const MdOptions& options, const MdSystem& system, std::uint64_t seed) {
    const Axis x{system.length.x, system.walls_x};
    const Axis y{system.length.y, system.walls_y};
    const auto wanted = static_cast<std::size_t>(options.cell.grains);
    if (system.vertical == Vertical::periodic || system.length.z >= low_cell) {
        const Axis z{system.length.z, system.vertical == Vertical::plates};
        return {choose(cubic_sites({x, y, z}, wanted), wanted, seed), true};
    }
    if (options.initial.layout == InitialLayout::square) {
        return {patch_sites(options, x, y, seed), false};
    }
    const auto singles = static_cast<std::int64_t>(x.most_sites()) * y.most_sites();
    if (options.cell.grains <= singles) {
        return {choose(single_sites(x, y, system.length.z, seed), wanted, seed), false};
    }
    return {choose(bilayer_sites(x, y, system.length.z, wanted), wanted, seed), true};
}

void draw_velocities(GrainState& state, const MdSystem& system, double temperature,
                     std::uint64_t seed) {
    const double width = std::sqrt(temperature);
    Vec3 mean;
    for (std::size_t i = 0; i < state.size(); ++i) {
        RandomStream random(seed, "md velocities", static_cast<std::uint64_t>(state.id[i]));
        Vec3& v = state.velocity[i];
        v.x = width * random.normal();
        v.y = width * random.normal();
        v.z = width * random.normal();
        mean += v;
    }
    if (state.size() < 2) return;
    mean = (1 / static_cast<double>(state.size())) * mean;
    if (system.walls_x) mean.x = 0;
    if (system.walls_y) mean.y = 0;
    if (system.vertical == Vertical::plates) mean.z = 0;
    for (Vec3& v : state.velocity) v -= mean;
}

void melt(GrainState& state, MdSystem system, double collisions_per_grain, std::uint64_t seed) {
    system.grain = system.plate = {.restitution = 1,
                                   .tangential_restitution = -1,
                                   .static_friction = 0,
                                   .dynamic_friction = 0};
    system.gravity = 0;
    system.amplitude = 0;
    system.contact_time = 0;
    const auto engine = make_engine(system, {});
    draw_velocities(state, system, 1, seed);
    const double wanted = 0.5 * collisions_per_grain * static_cast<double>(state.size());
    constexpr double window = 0.5;
    constexpr int most_windows = 10000;
    constexpr int slices = 8;  // a large gas takes seconds for a window; pauses do not matter
    double done = 0;
    for (int i = 0; i < most_windows && done < wanted; ++i) {
        engine->load(state, window);
        for (int k = 1; k <= slices; ++k) {
            throw_if_interrupted("melting the initial state");
            engine->advance(window * k / slices);
        }
        done += static_cast<double>(engine->ledger().pair);
        engine->store(window, state);
    }
}

// Interleaves the lowest 21 bits of the coordinates.
std::uint64_t z_order(const Vec3& r) {
    const auto spread = [](double x) {
        auto v = static_cast<std::uint64_t>(std::max(x, 0.0)) & 0x1fffff;
        v = (v | v << 32) & 0x001f00000000ffff;
        v = (v | v << 16) & 0x001f0000ff0000ff;
        v = (v | v << 8) & 0x100f00f00f00f00f;
        v = (v | v << 4) & 0x10c30c30c30c30c3;
        return (v | v << 2) & 0x1249249249249249;
    };
    return spread(r.x) | spread(r.y) << 1 | spread(r.z) << 2;
}

template <class T>
void permute(std::vector<T>& column, const std::vector<std::uint32_t>& order) {
    if (column.empty()) return;
    std::vector<T> sorted(column.size());
    for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = column[order[i]];
    column.swap(sorted);
}

void require_same(bool is_same, const std::string& option, const std::string& in_options,
                  const std::string& in_snapshot) {
    if (is_same) return;
    throw OptionError(
        {.problem = option + " differs from the snapshot to start from",
         .actual = in_options,
         .expected = in_snapshot + ", as in the snapshot",
         .suggestion = "give the cell of the run that the snapshot comes from (its -c file)"});
}

// Lengths come back from files as they were written; 1e-9 leaves room for other programs.
void require_same_cell(const Snapshot& snapshot, const MdOptions& options) {
    const CellOptions& cell = options.cell;
    const Box& box = snapshot.box;
    const auto length = [](const char* option, double here, double there) {
        require_same(std::abs(here - there) <= 1e-9 * here, option, fmt::format("{:.10g} a", here),
                     fmt::format("{:.10g} a", there));
    };
    const auto side = [](const char* option, Side here, Boundary there) {
        const auto name = [](bool walls) { return walls ? "walls" : "periodic"; };
        const bool walls = here == Side::walls;
        const bool has_walls = there == Boundary::walls;
        require_same(walls == has_walls, option, name(walls), name(has_walls));
    };
    length("cell.length-x", cell.length_x, box.length.x);
    length("cell.length-y", cell.length_y, box.length.y);
    if (box.height > 0) length("cell.height", cell.height, box.height);
    side("cell.sides-x", cell.sides_x, box.boundary[0]);
    side("cell.sides-y", cell.sides_y, box.boundary[1]);
    require_same(cell.grains == static_cast<std::int64_t>(snapshot.size()), "cell.grains",
                 std::to_string(cell.grains), std::to_string(snapshot.size()));
}

// A run begins with the plates passing their mean position upwards.
void require_phase_zero(const Snapshot& snapshot, const TrajectoryInfo& source) {
    if (!source.vibration_frequency) return;
    const double periods = snapshot.time * *source.vibration_frequency;
    const double phase = periods - std::round(periods);
    if (std::abs(phase) < 1e-6) return;
    throw OptionError(
        {.problem = fmt::format("start-frame: frame {} was not taken at phase 0 of the vibration",
                                snapshot.frame),
         .actual = fmt::format("phase {:.6g}", phase < 0 ? phase + 1 : phase),
         .expected = "0, where the plates pass their mean position upwards",
         .suggestion = "choose another start-frame, or write one with run.snapshot-phase = 0"});
}

}  // namespace

GrainState make_initial_state(const MdOptions& options, std::uint64_t seed) {
    constexpr double enough_to_melt = 100;
    const MdSystem system = options.system();
    const Sites sites = sites_for(options, system, seed);
    GrainState state;
    state.resize(sites.place.size());
    state.position = sites.place;
    std::iota(state.id.begin(), state.id.end(), 0);
    const double mixing = options.initial.melt.value_or(sites.is_lattice ? enough_to_melt : 0);
    if (mixing > 0 && state.size() > 1) melt(state, system, mixing, seed);
    draw_velocities(state, system, options.initial.temperature, seed);
    if (system.contact_time > 0) state.last_contact.assign(state.size(), no_contact_yet);
    return state;
}

GrainState state_of(const Snapshot& snapshot, const TrajectoryInfo& source,
                    const MdOptions& options, std::uint64_t seed) {
    const MdSystem system = options.system();
    require_consistent(snapshot);
    const auto fail = [&snapshot](const std::string& what, const std::string& suggestion) {
        throw InputError({.problem = fmt::format("cannot start from frame {}", snapshot.frame),
                          .actual = what,
                          .expected = {},
                          .suggestion = suggestion});
    };
    if (snapshot.z.empty()) fail("no heights", "start from the output of 'simulate md'");
    require_same_cell(snapshot, options);
    require_phase_zero(snapshot, source);
    GrainState state;
    state.resize(snapshot.size());
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const Vec2 p = snapshot.position[i] - snapshot.box.origin;
        state.position[i] = {p.x, p.y, snapshot.z[i]};
        state.id[i] = static_cast<std::int32_t>(i);
        if (p.x < 0 || p.y < 0 || p.x > system.length.x || p.y > system.length.y ||
            snapshot.z[i] < 0 || snapshot.z[i] > system.length.z) {
            fail(fmt::format("particle {} at ({:g}, {:g}, {:g}) is outside the cell", i, p.x, p.y,
                             snapshot.z[i]),
                 "give cell.length-x, cell.length-y and cell.height of that run");
        }
    }
    if (snapshot.velocity.empty()) {
        draw_velocities(state, system, options.initial.temperature, seed);
    } else {
        state.velocity = snapshot.velocity;
    }
    if (!snapshot.spin.empty()) state.spin = snapshot.spin;
    if (system.contact_time > 0) state.last_contact.assign(state.size(), no_contact_yet);
    const auto engine = make_engine(system, {});
    engine->load(state, 0);
    if (engine->max_overlap() > permitted_overlap) {
        fail(fmt::format("spheres overlap by {:g} a", engine->max_overlap()),
             "start from a frame of a run with spheres of diameter a in this cell");
    }
    return state;
}

void sort_in_space(GrainState& state) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> key(state.size());
    for (std::size_t i = 0; i < key.size(); ++i) {
        key[i] = {z_order(state.position[i]), static_cast<std::uint32_t>(i)};
    }
    std::ranges::sort(key, [&state](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : state.id[a.second] < state.id[b.second];
    });
    std::vector<std::uint32_t> order(key.size());
    for (std::size_t i = 0; i < key.size(); ++i) order[i] = key[i].second;
    permute(state.position, order);
    permute(state.velocity, order);
    permute(state.spin, order);
    permute(state.id, order);
    permute(state.last_contact, order);
}

}  // namespace grainfield::simulate
