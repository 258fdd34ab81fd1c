// Bias of S(k) and cost of every scheme and step, on one path of psi: density noise is integrated
// out by the adjoint of the scheme, and psi is carried through in steps of 0.05 whatever dt. Then
// the statistical error of the direct and the adjoint estimate a unit of time.
//   bench.field.error [nu = 0.01] [cells = 128] [time = 300] [seed = 1] [cells of the timing = 512]
// bench/field/run-time-error draws what it prints.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/density/field_statistics.h"
#include "simulate/field/field_run.h"
#include "simulate/field/integrators/adjoint.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "tests/simulate/field/integrators/plain_adjoint.h"

using namespace grainfield;
using namespace grainfield::simulate;

namespace {

constexpr double fine = 0.05;
constexpr double all = 1e9;
constexpr double spacing = 0.65;

struct Settings {
    double nu = 0.01;
    int cells = 128;
    double time = 300;
    std::uint64_t seed = 1;
    int timed_cells = 512;

    int unit() const { return std::max(1, cells / 64); }  ///< k = 0.151 for multiples of 64
};

struct Case {
    FieldScheme scheme;
    double dt, k_cut;
    int hold;
};

const char* name_of(FieldScheme scheme) {
    switch (scheme) {
        case FieldScheme::lod:
            return "lod";
        case FieldScheme::explicit_lm:
            return "explicit";
        case FieldScheme::paper:
            return "paper";
    }
    return "";
}

constexpr int multiples[] = {1, 2, 8, 16};

FieldSetup setup_of(const Settings& settings, const Case& c) {
    FieldSetup setup;
    setup.lattice = {2, settings.cells, settings.cells, spacing};
    setup.dt = c.dt;
    setup.scheme = c.scheme;
    setup.model.nu = settings.nu;
    setup.k_cut = c.k_cut;
    setup.hold = c.hold;
    setup.substeps = static_cast<int>(std::lround(c.dt * c.hold / fine));
    setup.twofold = true;
    setup.seed = settings.seed;
    return setup;
}

/// For each wavenumber a wave along x and one along the diagonal: splitting the directions costs
/// accuracy there only.
std::vector<LatticeWave> waves_of(const Settings& settings) {
    std::vector<LatticeWave> waves;
    for (const int m : multiples) {
        const int n = m * settings.unit();
        const int diagonal = static_cast<int>(std::lround(n / std::numbers::sqrt2));
        waves.push_back({n, 0});
        waves.push_back({diagonal, diagonal});
    }
    return waves;
}

/// S at the four wavenumbers, by the program's own adjoint.
std::vector<double> spectrum_of_lod(const Settings& settings, const Case& c) {
    const std::vector<LatticeWave> waves = waves_of(settings);
    AdjointEstimator adjoint(setup_of(settings, c), waves, 1, 0);
    adjoint.advance(std::lround(settings.time / c.dt));
    std::vector<double> s;
    for (std::size_t w = 0; w < waves.size(); w += 2) {
        s.push_back((adjoint.under_way(w) + adjoint.under_way(w + 1)) / 2);
    }
    return s;
}

std::vector<double> diffusivity(const FieldIntegrator& path) {
    std::vector<double> d = path.order().value;
    for (double& x : d) x = std::exp(-x * x);
    return d;
}

/// The same for the other schemes, by the transposed step.
std::vector<double> spectrum_of_other(const Settings& settings, const Case& c) {
    // The density of this integrator is not looked at: it carries psi.
    Case carrier{FieldScheme::lod, c.dt * c.hold, c.k_cut, 1};
    const auto path = make_integrator(setup_of(settings, carrier), 1);
    std::vector<testing::PlainAdjoint> waves;
    for (const LatticeWave wave : waves_of(settings)) {
        waves.emplace_back(settings.cells, spacing, wave.nx, wave.ny);
    }
    std::vector<double> d = diffusivity(*path);
    const auto intervals = std::lround(settings.time / (c.dt * c.hold));
    for (long i = 0; i < intervals; ++i) {
        path->advance(1);
        std::vector<double> next = diffusivity(*path);
        // As published D is that at the beginning of a step, which is its end in reversed time.
        std::vector<double> used = next;
        if (c.scheme == FieldScheme::explicit_lm) {
            for (std::size_t j = 0; j < used.size(); ++j) used[j] = (d[j] + next[j]) / 2;
        }
        for (testing::PlainAdjoint& wave : waves) {
            for (int h = 0; h < c.hold; ++h) {
                if (c.scheme == FieldScheme::explicit_lm) {
                    wave.leimkuhler_matthews(used, c.dt, 1);
                } else {
                    wave.peaceman_rachford(used, c.dt, 1);
                }
            }
        }
        d = std::move(next);
    }
    std::vector<double> s;
    for (std::size_t w = 0; w < waves.size(); w += 2) {
        s.push_back((waves[w].sum() + waves[w + 1].sum()) / 2);
    }
    return s;
}

/// What a unit of time of the direct simulation costs [ms]: float, one thread, least of three.
double cost(const Settings& settings, const Case& c) {
    FieldSetup setup = setup_of(settings, c);
    setup.lattice.nx = setup.lattice.ny = settings.timed_cells;
    setup.substeps = 1;
    setup.twofold = false;
    const auto fields = make_integrator(setup, 1);
    const int steps = 20;
    fields->advance(steps);
    double least = 1e300;
    for (int repetition = 0; repetition < 3; ++repetition) {
        const auto start = std::chrono::steady_clock::now();
        fields->advance(steps);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        least = std::min(least, took.count());
    }
    return 1e3 * least / steps / c.dt;
}

struct NothingStored : FieldSink {
    void write(const FieldFrame&) override {}
};

/// Relative error of S of one shell times the root of the recorded time, for the timed lattice:
/// the estimate averages over its area, so that errors scale as 1/length.
void print_statistical_errors(const Settings& settings) {
    const double area = static_cast<double>(settings.cells) / settings.timed_cells;
    const Case c{FieldScheme::lod, 0.5, 2.05, 1};
    FieldSetup setup = setup_of(settings, c);
    setup.twofold = false;
    setup.substeps = 1;
    const double relax = 500, record = 100 * settings.time;
    const auto fields = make_integrator(setup, 1);
    const FieldSchedule schedule{std::lround(relax / c.dt), std::lround(record / 2), 4, 0};
    analysis::FieldStatistics statistics({.k_max = 2.6}, schedule.samples);
    NothingStored nothing;
    FieldRun run(*fields, schedule, statistics, nothing);
    while (!run.is_done()) run.advance(1 << 20);
    const double step = 2 * std::numbers::pi / (settings.cells * spacing);
    for (const ObservableResult& result : statistics.results()) {
        if (result.name != "sk") continue;
        const Curve& curve = result.curves.front();
        for (const int m : multiples) {
            // The shells around it, each an estimate of its error.
            const double k = m * settings.unit() * step;
            double sum = 0;
            int shells = 0;
            for (std::size_t i = 0; i < curve.columns[0].values.size(); ++i) {
                const double distance = std::abs(curve.columns[0].values[i] - k);
                if (distance > std::max(1.5 * step, 0.1 * k)) continue;
                const double relative = curve.columns[2].values[i] / curve.columns[1].values[i];
                if (!std::isfinite(relative)) continue;
                sum += relative * relative;
                ++shells;
            }
            fmt::print("error direct k={:.2f} {:.4g}\n", k,
                       area * std::sqrt(sum / shells * record));
        }
    }
    std::vector<LatticeWave> waves;
    for (const int m : {1, 2}) {
        waves.push_back({m * settings.unit(), 0});
        waves.push_back({0, m * settings.unit()});
    }
    AdjointEstimator adjoint(setup, waves, 1);
    const double time = 60 * settings.time;
    adjoint.advance(std::lround(time / c.dt));
    for (std::size_t w = 0; w < waves.size(); w += 2) {
        std::vector<double> samples = adjoint.samples(w);
        samples.insert(samples.end(), adjoint.samples(w + 1).begin(), adjoint.samples(w + 1).end());
        double mean = 0, squares = 0;
        for (const double s : samples) mean += s / static_cast<double>(samples.size());
        for (const double s : samples) squares += (s - mean) * (s - mean);
        const auto n = static_cast<double>(samples.size());
        // Waves of one length share psi: no more than n/2 are counted as independent.
        fmt::print("error adjoint k={:.2f} {:.4g}  ({} samples)\n", adjoint.wavenumber(w),
                   area * std::sqrt(squares / (n - 1) / (n / 2) * time) / mean, samples.size());
    }
    FieldSetup timed = setup;
    timed.lattice.nx = timed.lattice.ny = settings.timed_cells;
    AdjointEstimator large(timed, waves, 1);
    large.advance(10);
    const auto start = std::chrono::steady_clock::now();
    large.advance(10);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    fmt::print("cost adjoint {:.3f}\n", 1e3 * took.count() / 10 / c.dt);
}

}  // namespace

int main(int argc, char** argv) {
    const auto number = [&](int i, double otherwise) {
        return argc > i ? std::atof(argv[i]) : otherwise;
    };
    Settings settings;
    settings.nu = number(1, settings.nu);
    settings.cells = static_cast<int>(number(2, settings.cells));
    settings.time = number(3, settings.time);
    settings.seed = static_cast<std::uint64_t>(number(4, 1));
    settings.timed_cells = static_cast<int>(number(5, settings.timed_cells));

    using enum FieldScheme;
    std::vector<double> reference;
    fmt::print(
        "# nu {} cells {} time {}, cost on {} squared: scheme dt k_cut hold "
        "ms_per_unit_time, bias in % at each k\n",
        settings.nu, settings.cells, settings.time, settings.timed_cells);
    for (const Case& c : {Case{lod, fine, all, 1},
                          {lod, fine, 2.4, 1},
                          {lod, fine, 2.05, 1},
                          {lod, fine, 1.5, 1},
                          {lod, fine, all, 4},
                          {lod, fine, all, 10},
                          {lod, 0.1, all, 1},
                          {lod, 0.2, all, 1},
                          {lod, 0.5, all, 1},
                          {lod, 0.5, 2.05, 1},
                          {lod, 1, all, 1},
                          {lod, 1, 2.05, 1},
                          {lod, 2, all, 1},
                          {lod, 4, all, 1},
                          {explicit_lm, fine, all, 1},
                          {explicit_lm, fine, all, 4},
                          {explicit_lm, fine, all, 10},
                          {explicit_lm, 0.1, all, 1},
                          {explicit_lm, 0.1, all, 5},
                          {paper, fine, all, 1},
                          {paper, 0.1, all, 1},
                          {paper, 0.2, all, 1},
                          {paper, 0.5, all, 1}}) {
        const std::vector<double> s =
            c.scheme == lod ? spectrum_of_lod(settings, c) : spectrum_of_other(settings, c);
        if (reference.empty()) reference = s;
        fmt::print("{} {:g} {:g} {} {:.3f}", name_of(c.scheme), c.dt, c.k_cut, c.hold,
                   cost(settings, c));
        for (std::size_t w = 0; w < s.size(); ++w) {
            const double k =
                2 * std::numbers::pi * multiples[w] * settings.unit() / (settings.cells * spacing);
            fmt::print(" k={:.2f} {:+.3f}", k, 100 * (s[w] / reference[w] - 1));
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
    print_statistical_errors(settings);
}
