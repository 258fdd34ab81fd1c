#include "simulate/md/md_simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

namespace {

constexpr std::int64_t windows_between_sorts = 4;
// Signals are asked for and the pressure is averaged: exact for the first seven harmonics of the
// vibration, and no more often than strips stop anyway.
constexpr double slices_per_period = 8;

// About a million events: long enough that planning all grains anew costs little.
std::int64_t window_length(std::size_t grains) {
    const double events_per_period = 10 * static_cast<double>(std::max<std::size_t>(grains, 1));
    return static_cast<std::int64_t>(std::clamp(1e6 / events_per_period, 1.0, 10.0));
}

void explain(const MdSystem& system, RunPlan& plan) {
    const bool smooth = system.grain.is_smooth() && system.plate.is_smooth();
    plan.run("free flight", "analytic, one event per grain in a calendar");
    if (smooth) {
        plan.skip("rotation", "no friction: spins never change",
                  "impulses along the contact and their spins");
    } else {
        plan.run("rotation", "tangential impulses turn the grains");
    }
    if (system.gravity == 0) {
        plan.skip("gravity", "g = 0", "parabolas");
    } else {
        plan.run("gravity", fmt::format("g = {:g}", system.gravity));
    }
    if (system.vertical == Vertical::periodic) {
        plan.skip("plates", "periodic in z", "the plate solver");
    } else if (!system.is_vibrating()) {
        plan.skip("sinusoidal plates", "plates are at rest: contact times in closed form",
                  "sines and iterations");
    } else {
        const auto control = control_of(system);
        plan.run("sinusoidal plates",
                 fmt::format("A = {:g} a, ω = {:g} sqrt(g/a){}", system.amplitude,
                             system.angular_frequency,
                             control ? fmt::format(", Γ = {:.4g}", control->value) : ""));
    }
    if (system.contact_time > 0) {
        plan.run("contact-time model", fmt::format("t_c = {:g}", system.contact_time));
    } else {
        plan.skip("contact-time model", "off", "one comparison a collision");
    }
}

/// Takes arrays out of a checkpoint, or refuses it with the reason.
struct CheckpointReader {
    const Checkpoint& checkpoint;
    const std::string& file;

    [[noreturn]] void refuse(const char* name, const std::string& actual,
                             const std::string& expected) const {
        throw InputError({.problem = fmt::format("cannot go on from {}", file),
                          .actual = fmt::format("'{}': {}", name, actual),
                          .expected = expected,
                          .suggestion = "start again without option 'resume'"});
    }
    template <class T>
    const std::vector<T>& find(const std::map<std::string, std::vector<T>>& arrays,
                               const char* name, std::optional<std::size_t> count) const {
        const auto found = arrays.find(name);
        if (found == arrays.end()) refuse(name, "not there", {});
        if (count && found->second.size() != *count) {
            refuse(name, fmt::format("{} numbers", found->second.size()),
                   fmt::format("{}", *count));
        }
        return found->second;
    }
    const std::vector<std::int64_t>& integers(const char* name,
                                              std::optional<std::size_t> count = {}) const {
        return find(checkpoint.integers, name, count);
    }
    const std::vector<double>& reals(const char* name,
                                     std::optional<std::size_t> count = {}) const {
        const std::vector<double>& numbers = find(checkpoint.reals, name, count);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (!std::isfinite(numbers[i])) {
                refuse(name, fmt::format("{} at position {}", numbers[i], i), "finite numbers");
            }
        }
        return numbers;
    }
    std::vector<Vec3> vectors(const char* name, std::size_t count) const {
        const std::vector<double>& numbers = reals(name, 3 * count);
        std::vector<Vec3> values(count);
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
        }
        return values;
    }
};

void explain_strips(int strips, int threads, RunPlan& plan) {
    if (strips > 1) {
        plan.run("strips of the cell", fmt::format("{} at a time on {} threads", strips, threads));
    } else if (threads > 1) {
        plan.skip("strips of the cell",
                  "two need 64 rows of cells each to gain from a second thread",
                  "seams and waiting for each other");
    }
}

}  // namespace

void require_clean_contacts(const Ledger& ledger, double permitted, double first, double period) {
    const auto require = [&](const Deepest& contact, double depth) {
        if (depth <= permitted) return;
        const std::string partner =
            contact.second < 0 ? "a plate or wall" : fmt::format("grain {}", contact.second);
        throw PhysicsError(
            {.problem = fmt::format("overlap: grain {} meets {} at period {:.17g}", contact.first,
                                    partner, first + contact.time / period),
             .actual = fmt::format("{:g} a deep", depth),
             .expected = fmt::format("less than {:g} a", permitted),
             .suggestion = "report this run with its configuration and seed"});
    };
    const double square = std::max(1 - ledger.deepest_pair.depth, 0.0);
    require(ledger.deepest_pair, 1 - std::sqrt(square));
    require(ledger.deepest_plate, ledger.deepest_plate.depth);
}

MdSimulation::MdSimulation(const MdOptions& options, GrainState initial, int threads, RunPlan& plan)
    : options_(options),
      system_(options.system()),
      state_(std::move(initial)),
      series_(system_, static_cast<std::int64_t>(state_.size())),
      sums_(sum_count, 0),
      settled_last_(sum_count, 0),
      last_sample_sums_(sum_count, 0) {
    explain(system_, plan);
    EngineOptions engine;
    engine.threads = threads;
    engine.tiles = options.run.tiles;
    engine.event_limit = static_cast<double>(options.run.event_limit);
    engine_ = make_engine(system_, engine);
    explain_strips(engine_->strips(), threads, plan);
    window_periods_ = window_length(state_.size());
}

double MdSimulation::periods_done() const {
    return std::min(static_cast<double>(window_ * window_periods_), options_.run.periods);
}

std::vector<double> MdSimulation::present_sums() const {
    std::vector<double> sums = sums_of(engine_->ledger());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (!std::isfinite(sums[i])) {
            throw PhysicsError({.problem = "an event exchanged more energy than can be summed",
                                .actual = "more than 4.5e15 m g a",
                                .expected = {},
                                .suggestion = "lower the amplitude, frequency or temperature"});
        }
        sums[i] += sums_[i];
    }
    return sums;
}

void MdSimulation::sample(double time) {
    const std::vector<double> sums = present_sums();
    const Energies energies = engine_->energies(time);
    energy_now_ = energies.total();
    if (series_.size() == 0) energy_start_ = energy_now_;
    const double kinetic = kinetic_.slices > 0 ? kinetic_.sum / kinetic_.slices
                                               : energies.horizontal + energies.vertical;
    series_.add(static_cast<double>(window_ * window_periods_) + time / system_.period(), energies,
                sums, kinetic);
    last_sample_sums_ = sums;
    kinetic_ = {};
}

void MdSimulation::add_slice(double time) {
    const Energies energies = engine_->energies(time);
    kinetic_.sum += energies.horizontal + energies.vertical;
    kinetic_.slices += 1;
}

Snapshot MdSimulation::snapshot(double time, std::int64_t frame) const {
    GrainState now;
    engine_->store(time, now);
    const std::size_t count = now.size();
    Snapshot s;
    s.frame = frame;
    s.time = static_cast<double>(window_ * window_periods_) * system_.period() + time;
    const auto side = [](bool walls) { return walls ? Boundary::walls : Boundary::periodic; };
    s.box = {.origin = {0, 0},
             .length = {system_.length.x, system_.length.y},
             .boundary = {side(system_.walls_x), side(system_.walls_y)},
             .height = system_.length.z};
    s.position.resize(count);
    s.z.resize(count);
    s.velocity.resize(count);
    s.spin.resize(count);
    s.id.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(now.id[i]);
        s.position[k] = {now.position[i].x, now.position[i].y};
        s.z[k] = now.position[i].z;
        s.velocity[k] = now.velocity[i];
        s.spin[k] = now.spin[i];
        s.id[k] = now.id[i];
    }
    return s;
}

void MdSimulation::run_window(SnapshotSink& sink) {
    const RunOptions& run = options_.run;
    const double period = system_.period();
    const auto first = static_cast<double>(window_ * window_periods_);
    const double last = std::min(first + static_cast<double>(window_periods_), run.periods);
    if (window_ % windows_between_sorts == 0) sort_in_space(state_);
    engine_->load(state_, (last - first) * period);
    max_overlap_ = std::max(max_overlap_, engine_->max_overlap());
    if (engine_->max_overlap() > permitted_overlap) {
        throw PhysicsError({.problem = fmt::format("spheres overlap at period {:g}", first),
                            .actual = fmt::format("{:g} a", engine_->max_overlap()),
                            .expected = fmt::format("less than {:g} a", permitted_overlap),
                            .suggestion = "report this run with its configuration and seed"});
    }
    const auto snapshot_at = [&run](std::int64_t k) {
        return run.discard + run.snapshot_phase + static_cast<double>(k) * run.snapshot_every;
    };
    double slice = first;
    while (true) {
        const auto sample_at = static_cast<double>(next_sample_ * run.sample_every);
        const double stop = std::min({snapshot_at(next_snapshot_), sample_at, slice, last});
        const double time = (stop - first) * period;
        if (!advance_to(time, first)) return;
        // The border itself was the last slice of the window before.
        if (stop == slice) {
            if (stop > first) add_slice(time);
            slice += 1 / slices_per_period;
        }
        if (stop == sample_at) {
            sample(time);
            ++next_sample_;
        }
        if (stop == snapshot_at(next_snapshot_)) {
            sink.write(snapshot(time, next_snapshot_));
            ++next_snapshot_;
        }
        if (caught_signal() != 0) return;
        if (stop >= last) break;
    }
    settle();
}

// What rounding makes of a contact far from the origin, between fast grains, late in a window; or
// the overlaps that the run was given.
double MdSimulation::permitted_depth(double time) const {
    double speed = system_.amplitude * system_.angular_frequency + system_.gravity * time;
    for (const Vec3& v : state_.velocity) speed = std::max(speed, norm(v));
    const double longest = std::max({system_.length.x, system_.length.y, system_.length.z});
    const double rounding = 32 * std::numeric_limits<double>::epsilon() * (longest + speed * time);
    return std::max({1e-12, rounding, 2 * engine_->max_overlap()});
}

// The engine knows the time of its window only. False if a signal came: the window stays
// unfinished.
bool MdSimulation::advance_to(double time, double first) {
    try {
        engine_->advance(time);
        return true;
    } catch (const Interrupted&) {
        return false;
    } catch (const InelasticCollapse& error) {
        throw InelasticCollapse(
            fmt::format("{} The window began at period {:g}.", error.what(), first));
    }
}

void MdSimulation::settle() {
    const auto first = static_cast<double>(window_ * window_periods_);
    const double last =
        std::min(first + static_cast<double>(window_periods_), options_.run.periods);
    engine_->store((last - first) * system_.period(), state_);
    outdated_ += static_cast<double>(engine_->ledger().outdated);
    const Ledger& ledger = engine_->ledger();
    const double time = (last - first) * system_.period();
    require_clean_contacts(ledger, permitted_depth(time), first, system_.period());
    deepest_pair_ = std::max(deepest_pair_, ledger.deepest_pair.depth);
    deepest_plate_ = std::max(deepest_plate_, ledger.deepest_plate.depth);
    backwards_ = std::max(backwards_, ledger.backwards);
    sums_ = present_sums();
    ++window_;
    settled_snapshots_ = next_snapshot_;
    settled_rows_ = series_.size();
    settled_last_ = last_sample_sums_;
    settled_kinetic_ = kinetic_;
    settled_energy_ = energy_now_;
}

Checkpoint MdSimulation::checkpoint() const {
    Checkpoint c;
    c.kind = "md";
    const std::size_t n = state_.size();
    const auto flat = [n](const std::vector<Vec3>& column) {
        std::vector<double> numbers(3 * n);
        for (std::size_t i = 0; i < n; ++i) {
            numbers[3 * i] = column[i].x;
            numbers[3 * i + 1] = column[i].y;
            numbers[3 * i + 2] = column[i].z;
        }
        return numbers;
    };
    c.reals["position"] = flat(state_.position);
    c.reals["velocity"] = flat(state_.velocity);
    c.reals["spin"] = flat(state_.spin);
    c.reals["last_contact"] = state_.last_contact;
    c.reals["sums"] = sums_;
    c.reals["sums_at_last_sample"] = settled_last_;
    c.reals["series"] = series_.numbers(settled_rows_);
    c.reals["energy"] = {energy_start_, settled_energy_};
    c.reals["kinetic"] = {settled_kinetic_.sum, settled_kinetic_.slices};
    c.reals["periods"] = {periods_done()};
    c.reals["counts"] = {max_overlap_, deepest_pair_, deepest_plate_, outdated_, backwards_};
    c.integers["id"].assign(state_.id.begin(), state_.id.end());
    // Samples on the window's border belong to the window that ends there.
    const std::int64_t samples = static_cast<std::int64_t>(settled_rows_);
    c.integers["progress"] = {window_, settled_snapshots_, samples};
    return c;
}

void MdSimulation::restore(const Checkpoint& c, const std::string& file) {
    const CheckpointReader from{c, file};
    const auto& id = from.integers("id");
    const std::size_t n = id.size();
    if (static_cast<std::int64_t>(n) != options_.cell.grains) {
        from.refuse("id", fmt::format("{} grains", n), fmt::format("{}", options_.cell.grains));
    }
    std::vector<bool> seen(n, false);
    for (const std::int64_t i : id) {
        if (i < 0 || i >= static_cast<std::int64_t>(n) || seen[static_cast<std::size_t>(i)]) {
            from.refuse("id", fmt::format("{} twice or out of range", i), "each of 0 … N − 1 once");
        }
        seen[static_cast<std::size_t>(i)] = true;
    }
    const auto& progress = from.integers("progress", 3);
    for (const std::int64_t p : progress) {
        if (p < 0) from.refuse("progress", std::to_string(p), "≥ 0");
    }
    const double done = from.reals("periods", 1)[0];
    const auto settled = static_cast<double>(progress[0] * window_length(n));
    if (options_.run.periods < done) {
        from.refuse("periods", fmt::format("{:.10g} periods are done", done),
                    fmt::format("at most the {:.10g} of run.periods", options_.run.periods));
    }
    // The last window of a run ends with it. What follows would be cut into others.
    if (done != settled && options_.run.periods != done) {
        from.refuse("periods", fmt::format("the run ended after {:.10g} periods", done),
                    fmt::format("run.periods = {:.10g}", done));
    }
    const auto& series = from.reals("series");
    MdSeries restored(system_, static_cast<std::int64_t>(n));
    const std::size_t rows = static_cast<std::size_t>(progress[2]);
    if (series.size() != 1 + rows * restored.columns()) {
        from.refuse("series", fmt::format("{} numbers", series.size()),
                    fmt::format("{}", 1 + rows * restored.columns()));
    }
    const auto& sums = from.reals("sums", sum_count);
    const auto& last = from.reals("sums_at_last_sample", sum_count);
    const auto& energy = from.reals("energy", 2);
    const auto& kinetic = from.reals("kinetic", 2);
    const auto& counts = from.reals("counts", 5);
    state_.position = from.vectors("position", n);
    state_.velocity = from.vectors("velocity", n);
    state_.spin = from.vectors("spin", n);
    state_.last_contact.clear();
    if (system_.contact_time > 0) {
        // None of a run without the TC model, which goes on with it after a collapse.
        const bool had_model = !from.reals("last_contact").empty();
        state_.last_contact =
            had_model ? from.reals("last_contact", n) : std::vector<double>(n, no_contact_yet);
    }
    state_.id.assign(id.begin(), id.end());
    sums_ = sums;
    settled_last_ = last_sample_sums_ = last;
    series_ = std::move(restored);
    series_.restore(series, settled_last_);
    energy_start_ = energy[0];
    energy_now_ = settled_energy_ = energy[1];
    kinetic_ = settled_kinetic_ = {kinetic[0], kinetic[1]};
    max_overlap_ = counts[0];
    deepest_pair_ = counts[1];
    deepest_plate_ = counts[2];
    outdated_ = counts[3];
    backwards_ = counts[4];
    window_ = progress[0];
    next_snapshot_ = settled_snapshots_ = progress[1];
    next_sample_ = progress[2];
    settled_rows_ = series_.size();
    window_periods_ = window_length(state_.size());
}

TrajectoryInfo MdSimulation::info() const {
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.length_unit = LengthUnit::diameter;
    info.time_unit = TimeUnit::sqrt_a_over_g;
    info.diameter = 1;
    info.diameter_origin = DiameterOrigin::simulated;
    info.control = control_of(system_);
    if (system_.is_vibrating()) info.vibration_frequency = 1 / system_.period();
    info.frame_rate = 1 / (options_.run.snapshot_every * system_.period());
    return info;
}

std::int64_t MdSimulation::events() const {
    return std::llround(sums_[sum_pair] + sums_[sum_low] + sums_[sum_high] + sums_[sum_wall]);
}

double MdSimulation::max_overlap() const {
    return std::max(max_overlap_, 1 - std::sqrt(1 - deepest_pair_));
}

double MdSimulation::energy_audit() const {
    const double losses = last_sample_sums_[sum_pair_loss] + last_sample_sums_[sum_plate_loss];
    const double work = last_sample_sums_[sum_work];
    const double scale = std::max({std::abs(work), losses, std::abs(energy_start_), 1e-300});
    return std::abs(energy_now_ - energy_start_ + losses - work) / scale;
}

double MdSimulation::outdated_per_event() const {
    return outdated_ / std::max(1.0, static_cast<double>(events()));
}

std::size_t MdSimulation::bytes() const {
    return engine_->bytes() + state_.size() * (3 * sizeof(Vec3) + sizeof(std::int32_t)) +
           state_.last_contact.size() * sizeof(double);
}

}  // namespace grainfield::simulate
