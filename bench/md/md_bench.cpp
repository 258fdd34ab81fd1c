// Events per second of the event-driven engine, with the error of the energy audit beside it.
//
//   bench.simulate.md [CASE …]      all cases without arguments
//
// One line a case: name, N, threads, real events (pair + plate + wall) per second, median of the
// windows after the first, relative audit error, memory of the engine, peak resident memory of the
// process. "paper" is the literal reading (μ = 0.03), "paper-file" is data-samples/md-paper.toml.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"

namespace {

using namespace grainfield::simulate;

MdOptions layer(double length, double amplitude) {
    MdOptions o;
    o.cell.length_x = o.cell.length_y = length;
    o.cell.grains = std::llround(0.9875 * length * length);
    o.vibration.amplitude = amplitude;
    return o;
}

MdOptions gas(std::int64_t grains) {
    MdOptions o;
    o.cell.grains = grains;
    o.cell.length_x = o.cell.length_y = o.cell.height =
        std::cbrt(static_cast<double>(grains) * std::numbers::pi / (6 * 0.45));
    o.cell.vertical = Vertical::periodic;
    o.cell.gravity = 0;
    o.vibration.amplitude = 0;
    o.grain = o.plate = {1, -1, 0, 0};
    o.initial.temperature = 1;
    o.initial.melt = 10;
    return o;
}

struct Case {
    MdOptions options;
    int threads = 1;
    int windows = 5;
};

double now() {
    using Clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

// Of the process, all threads: what a shared machine gives to others does not count.
double processor_time() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Of the process so far, [MB]: run one case alone to know what it needs.
double peak_memory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}

// data-samples/md-paper.toml as it is: contacts stick up to 0.3.
MdOptions paper_file() {
    MdOptions o = layer(600, 0.092);
    o.grain.static_friction = o.plate.static_friction = 0.3;
    return o;
}

void run(const std::string& name, const Case& c) {
    const MdSystem system = c.options.system();
    GrainState state = make_initial_state(c.options, 1);
    sort_in_space(state);  // as a run does
    EngineOptions options;
    options.threads = c.threads;
    const auto engine = make_engine(system, options);
    const double window = system.period();
    std::vector<double> rate;
    std::vector<double> processor_rate;
    double first = 0;
    double losses = 0;
    double work = 0;
    double start = 0;
    for (int w = 0; w < c.windows; ++w) {
        const double begin = now();
        const double processor_begin = processor_time();
        engine->load(state, window);
        if (w == 0) start = engine->energies(0).total();
        engine->advance(window);
        engine->store(window, state);
        const Ledger& ledger = engine->ledger();
        const auto events = static_cast<double>(ledger.real_events());
        if (w == 0) {
            first = events / (now() - begin);
        } else {
            rate.push_back(events / (now() - begin));
            processor_rate.push_back(events / (processor_time() - processor_begin));
        }
        losses += ledger.pair_loss.value() + ledger.plate_loss.value();
        work += ledger.work.value();
    }
    const double end = engine->energies(window).total();
    const double scale = std::max({std::abs(work), losses, start});
    std::sort(rate.begin(), rate.end());
    std::sort(processor_rate.begin(), processor_rate.end());
    fmt::print(
        "{:22} N {:7} threads {} {:9.3g} events/s  (min {:.3g}, max {:.3g}, first window {:.3g}; "
        "{:.3g} per processor second)  audit {:.1e}  engine {:.0f} MB, peak {:.0f} MB  {}\n",
        name, state.size(), c.threads, rate[rate.size() / 2], rate.front(), rate.back(), first,
        processor_rate[processor_rate.size() / 2], std::abs(end - start + losses - work) / scale,
        static_cast<double>(engine->bytes()) / 1e6, peak_memory_mb(), engine->policies());
    std::fflush(stdout);
}

std::vector<std::pair<std::string, Case>> cases() {
    std::vector<std::pair<std::string, Case>> all;
    all.push_back({"gas-10976", {gas(10976), 1, 12}});
    all.push_back({"gas-340736", {gas(340736), 1, 3}});
    all.push_back({"small", {layer(100, 0.08), 1, 20}});
    all.push_back({"paper", {layer(600, 0.092), 1, 4}});
    all.push_back({"paper-file", {paper_file(), 1, 4}});
    all.push_back({"paper-2-threads", {layer(600, 0.092), 2, 4}});
    // What each skip saves: the layer at A = 0.08 with one thing less at a time.
    MdOptions smooth = layer(100, 0.08);
    smooth.grain.static_friction = smooth.grain.dynamic_friction = 0;
    smooth.plate.static_friction = smooth.plate.dynamic_friction = 0;
    all.push_back({"skip-rotation", {smooth, 1, 20}});
    MdOptions still = layer(100, 0);
    still.grain.restitution = still.plate.restitution = 1;
    still.grain.static_friction = still.grain.dynamic_friction = 0;
    still.plate = still.grain;
    all.push_back({"skip-vibration", {still, 1, 20}});
    still.cell.gravity = 0;
    all.push_back({"skip-gravity", {still, 1, 20}});
    for (const double tolerance : {1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
        MdOptions loose = layer(100, 0.08);
        loose.run.plate_tolerance = tolerance;
        all.push_back({fmt::format("tolerance-{:.0e}", tolerance), {loose, 1, 12}});
    }
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> wanted(argv + 1, argv + argc);
    for (const auto& [name, c] : cases()) {
        const bool asked =
            wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
        if (asked) run(name, c);
    }
    return 0;
}
