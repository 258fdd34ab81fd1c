#include "simulate/md/md_simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/interrupt.h"
#include "simulate/md/initial_state.h"

namespace grainfield::simulate {

namespace {

constexpr std::int64_t windows_between_sorts = 4;
constexpr double slices_per_period = 16;  // how often signals are asked for

// About a million events: long enough that planning all grains anew costs little.
std::int64_t window_length(std::size_t grains) {
    const double events_per_period = 10 * static_cast<double>(std::max<std::size_t>(grains, 1));
    return static_cast<std::int64_t>(std::clamp(1e6 / events_per_period, 1.0, 10.0));
}

void explain(const MdSystem& system, RunPlan& plan) {
    const bool smooth = system.grain.is_smooth() && system.plate.is_smooth();
    plan.run("free flight", "analytic, one event per grain in a calendar");
    if (smooth) {
        plan.skip("rotation", "no friction: spins never change", "about 4 % of the time");
    } else {
        plan.run("rotation", "tangential impulses turn the grains");
    }
    if (system.gravity == 0) {
        plan.skip("gravity", "g = 0", "about 5 % of the time");
    } else {
        plan.run("gravity", fmt::format("g = {:g}", system.gravity));
    }
    if (system.vertical == Vertical::periodic) {
        plan.skip("plates", "periodic in z", "the plate solver");
    } else if (!system.is_vibrating()) {
        plan.skip("sinusoidal plates", "plates are at rest: contact times in closed form",
                  "sines and iterations, up to 20 % of the time");
    } else {
        plan.run("sinusoidal plates", fmt::format("A = {:g} a, ω = {:g} sqrt(g/a), Γ = {:.4g}",
                                                  system.amplitude, system.angular_frequency,
                                                  system.amplitude * system.angular_frequency *
                                                      system.angular_frequency));
    }
    if (system.contact_time > 0) {
        plan.run("contact-time model", fmt::format("t_c = {:g}", system.contact_time));
    } else {
        plan.skip("contact-time model", "off", "one comparison a collision");
    }
}

}  // namespace

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
    series_.add(static_cast<double>(window_ * window_periods_) + time / system_.period(), energies,
                sums);
    last_sample_sums_ = sums;
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
        engine_->advance(time);
        if (stop == sample_at) {
            sample(time);
            ++next_sample_;
        }
        if (stop == snapshot_at(next_snapshot_)) {
            sink.write(snapshot(time, next_snapshot_));
            ++next_snapshot_;
        }
        if (stop == slice) slice += 1 / slices_per_period;
        if (caught_signal() != 0) {
            interrupted_ = true;
            return;
        }
        if (stop >= last) break;
    }
    settle();
}

void MdSimulation::settle() {
    const auto first = static_cast<double>(window_ * window_periods_);
    const double last =
        std::min(first + static_cast<double>(window_periods_), options_.run.periods);
    engine_->store((last - first) * system_.period(), state_);
    outdated_ += static_cast<double>(engine_->ledger().outdated);
    sums_ = present_sums();
    ++window_;
    settled_snapshots_ = next_snapshot_;
    settled_rows_ = series_.size();
    settled_last_ = last_sample_sums_;
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
    c.reals["energy"] = {energy_start_, energy_now_, max_overlap_, outdated_};
    c.integers["id"].assign(state_.id.begin(), state_.id.end());
    // Samples on the window's border belong to the window that ends there.
    const std::int64_t samples = static_cast<std::int64_t>(settled_rows_);
    c.integers["progress"] = {window_, settled_snapshots_, samples};
    return c;
}

void MdSimulation::restore(const Checkpoint& c) {
    const auto damaged = [](const char* name) -> InputError {
        return InputError(fmt::format("the checkpoint has no valid '{}'.", name));
    };
    const auto reals = [&](const char* name) -> const std::vector<double>& {
        const auto found = c.reals.find(name);
        if (found == c.reals.end()) throw damaged(name);
        return found->second;
    };
    const auto integers = [&](const char* name) -> const std::vector<std::int64_t>& {
        const auto found = c.integers.find(name);
        if (found == c.integers.end()) throw damaged(name);
        return found->second;
    };
    const auto& id = integers("id");
    const auto& progress = integers("progress");
    const auto column = [&](const char* name, std::vector<Vec3>& values) {
        const std::vector<double>& numbers = reals(name);
        if (numbers.size() != 3 * id.size()) throw damaged(name);
        values.resize(id.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
        }
    };
    column("position", state_.position);
    column("velocity", state_.velocity);
    column("spin", state_.spin);
    state_.id.resize(id.size());
    for (std::size_t i = 0; i < id.size(); ++i) state_.id[i] = static_cast<std::int32_t>(id[i]);
    state_.last_contact = reals("last_contact");
    const bool has_contacts = system_.contact_time > 0;
    if (state_.last_contact.size() != (has_contacts ? id.size() : 0)) throw damaged("last_contact");
    if (progress.size() != 3) throw damaged("progress");
    if (reals("sums").size() != sum_count) throw damaged("sums");
    if (reals("sums_at_last_sample").size() != sum_count) throw damaged("sums_at_last_sample");
    if (reals("energy").size() != 4) throw damaged("energy");
    if (reals("series").empty()) throw damaged("series");
    sums_ = reals("sums");
    settled_last_ = last_sample_sums_ = reals("sums_at_last_sample");
    series_ = MdSeries(system_, static_cast<std::int64_t>(id.size()));
    series_.restore(reals("series"), settled_last_);
    energy_start_ = reals("energy")[0];
    energy_now_ = reals("energy")[1];
    max_overlap_ = reals("energy")[2];
    outdated_ = reals("energy")[3];
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
    if (system_.is_vibrating()) info.vibration_frequency = 1 / system_.period();
    info.frame_rate = 1 / (options_.run.snapshot_every * system_.period());
    return info;
}

std::int64_t MdSimulation::events() const {
    return std::llround(sums_[sum_pair] + sums_[sum_low] + sums_[sum_high] + sums_[sum_wall]);
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
