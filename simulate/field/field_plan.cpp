#include "simulate/field/field_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/parallel.h"
#include "simulate/field/integrators/explicit_integrator.h"
#include "simulate/field/model/order_spectrum.h"

namespace grainfield::simulate {

namespace {

constexpr double bias_of_cut = 5;      // times (2λv)²
constexpr double bias_of_hold = 0.01;  // a unit of time

Lattice lattice_of(const LatticeOptions& o) {
    const bool line = o.dimension == 1;
    if (line && o.ny > 1) {
        throw OptionError({.problem = "option 'lattice.ny' does not fit",
                           .actual = fmt::format("ny = {} in one dimension", o.ny),
                           .expected = "0 or 1",
                           .suggestion = "set dimension = 2, or leave ny out"});
    }
    if (!line && (o.ny == 1 || (o.ny == 0 && o.nx == 1))) {
        throw OptionError({.problem = "a lattice of one row is a line",
                           .actual = "dimension = 2, ny = 1",
                           .expected = "two rows or more",
                           .suggestion = "set dimension = 1"});
    }
    return {o.dimension, o.nx, line ? 1 : o.ny == 0 ? o.nx : o.ny, o.spacing};
}

void choose_scheme(const SchemeOptions& o, FieldPlan& result, RunPlan& plan) {
    const FieldSetup& setup = result.setup;
    const double bound = ExplicitIntegrator<double>::largest_step(setup.lattice, setup.model.d0);
    SchemeChoice choice = o.scheme;
    std::string why = "as asked for";
    if (choice == SchemeChoice::automatic) {
        const bool small = o.dt < 0.9 * bound;
        choice = small ? SchemeChoice::explicit_lm : SchemeChoice::lod;
        why = fmt::format("dt = {:g} is {} 0.9 of the explicit bound {:.4g}", o.dt,
                          small ? "below" : "not below", bound);
    }
    switch (choice) {
        case SchemeChoice::explicit_lm:
            result.setup.scheme = FieldScheme::explicit_lm;
            result.scheme = "explicit";
            plan.run("density", "explicit Leimkuhler-Matthews: " + why);
            break;
        case SchemeChoice::paper:
            result.setup.scheme = FieldScheme::paper;
            result.scheme = "paper";
            plan.run("density", "Peaceman-Rachford ADI as published: " + why);
            break;
        case SchemeChoice::adjoint:
            result.scheme = "adjoint";
            plan.run("density", "adjoint estimator of S(k) at chosen k: " + why);
            plan.skip("density noise", "the adjoint needs none", "about 0.7 ns a cell and step");
            break;
        default:
            plan.run("density", "LOD Crank-Nicolson with the mean diffusivity: " + why);
    }
}

// An implicit sweep reaches sqrt(dt D0)/dx cells far, which is what a line solver has to run on
// beyond the ends of its line.
void require_solvable(const FieldSetup& setup) {
    constexpr double most = 1e8;
    const double number =
        setup.dt * setup.model.d0 / (setup.lattice.spacing * setup.lattice.spacing);
    if (number <= most) return;
    throw OptionError({.problem = "the time step is too long for this lattice",
                       .actual = fmt::format("dt D0/dx^2 = {:.3g}", number),
                       .expected = fmt::format("at most {:g}", most),
                       .suggestion = "take a smaller scheme.dt or model.d0, or a wider lattice"});
}

// The smallest k whose modes above have a variance of at most `allowed`.
double cut_for(const Lattice& lattice, const ModelOptions& model, double allowed) {
    const double nyquist = std::numbers::pi / lattice.spacing * std::sqrt(2.0);
    double low = 0;
    double high = nyquist;
    for (int i = 0; i < 30; ++i) {
        const double middle = (low + high) / 2;
        const OrderSpectrum spectrum(lattice, model, 1, OrderScheme::exact, middle);
        (spectrum.missing_variance() > allowed ? low : high) = middle;
    }
    return high;
}

// Modes may be replaced by their average only where they are faster than the density at their own
// wavenumber: the smallest k beyond which g(k) ≥ 4 D0 k², at most `all`.
double fast_beyond(const ModelOptions& model, double all) {
    double slow = 0;
    constexpr int steps = 2000;
    for (int i = 1; i <= steps; ++i) {
        const double k = all * i / steps;
        if (decay_rate(model, k * k) < 4 * model.d0 * k * k) slow = k;
    }
    return slow;
}

void choose_cut(const SchemeOptions& o, FieldSetup& setup, RunPlan& plan) {
    const double all = 2 * std::numbers::pi / setup.lattice.spacing;
    setup.k_cut = o.k_cut.value_or(all);
    const bool may_skip =
        setup.model.form == DiffusivityForm::exponential && setup.scheme != FieldScheme::paper;
    if (!o.k_cut && may_skip) {
        const double share = o.tolerance / 4;
        setup.k_cut = std::max(cut_for(setup.lattice, setup.model,
                                       std::sqrt(share / bias_of_cut) / (2 * setup.model.lambda)),
                               fast_beyond(setup.model, all));
    }
    const OrderSpectrum spectrum(setup.lattice, setup.model, setup.dt, OrderScheme::exact,
                                 setup.k_cut);
    if (spectrum.kept() == spectrum.all()) {
        setup.k_cut = all;
        return;
    }
    const double x = 2 * setup.model.lambda * spectrum.missing_variance();
    const double share =
        1 - static_cast<double>(spectrum.kept()) / static_cast<double>(spectrum.all());
    plan.skip("order modes above k = " + fmt::format("{:.3g}", setup.k_cut),
              fmt::format("they change S by about {:.2g} %; D is averaged over them",
                          100 * bias_of_cut * x * x),
              fmt::format("{:.0f} % of the modes", 100 * share));
}

void choose_hold(const SchemeOptions& o, FieldSetup& setup, RunPlan& plan) {
    setup.hold = std::max(o.hold, 1);
    if (setup.scheme == FieldScheme::paper) setup.hold = 1;
    if (o.hold == 0 && setup.scheme == FieldScheme::explicit_lm) {
        const double most = o.tolerance / 2 / (bias_of_hold * setup.dt);
        setup.hold = std::max(1, static_cast<int>(std::min(most, 64.0)));
    }
    if (setup.hold == 1) return;
    plan.skip("order field between",
              fmt::format("one serves {} steps: S changes by about {:.2g} %", setup.hold,
                          100 * bias_of_hold * setup.hold * setup.dt),
              fmt::format("{} of {} transforms", setup.hold - 1, setup.hold));
}

void choose_noise(const FieldOptions& o, FieldSetup& setup, RunPlan& plan) {
    setup.noise = o.scheme.noise;
    if (setup.noise == NoiseShape::automatic) {
        setup.noise = o.record.store > 0 ? NoiseShape::normal : NoiseShape::uniform;
    }
    if (setup.noise == NoiseShape::uniform && o.scheme.scheme != SchemeChoice::adjoint) {
        plan.skip("Gaussian density noise",
                  "the density is linear in it: uniform noise gives the same second moments",
                  "two thirds of the random numbers' time");
    }
    const bool twofold = o.scheme.precision == Precision::twofold ||
                         (o.scheme.precision == Precision::automatic && o.scheme.tolerance < 1e-4);
    setup.twofold = twofold;
    if (!twofold) {
        plan.skip("double precision", "the tolerance is far above 1e-4; S is summed in double",
                  "half of the memory and time");
    }
}

FieldSchedule schedule_of(const RecordOptions& o, double dt) {
    const auto steps = [dt](double time) {
        return static_cast<std::int64_t>(std::llround(time / dt));
    };
    FieldSchedule schedule;
    schedule.relax = steps(o.relax);
    schedule.between_samples = std::max<std::int64_t>(1, steps(o.sample));
    schedule.samples = steps(o.record) / schedule.between_samples;
    schedule.between_stores = o.store > 0 ? std::max<std::int64_t>(1, steps(o.store)) : 0;
    return schedule;
}

void require_steps(const RecordOptions& o, double dt, const FieldSchedule& schedule,
                   RunPlan& plan) {
    const bool is_asked = o.relax > 0 || o.record > 0;
    if (is_asked && schedule.total() == 0) {
        throw OptionError({.problem = "no step fits into record.relax and record.record",
                           .actual = fmt::format("times of {:g} and {:g} at scheme.dt = {:g}",
                                                 o.relax, o.record, dt),
                           .expected = "one step or more",
                           .suggestion = "take a smaller scheme.dt or longer times"});
    }
    if (o.record > 0 && schedule.samples == 0) {
        plan.warn(
            fmt::format("no sample falls into record.record = {:g}: they come every {:g}; "
                        "there will be no statistics",
                        o.record, static_cast<double>(schedule.between_samples) * dt));
    }
}

std::vector<LatticeWave> waves_of(const SchemeOptions& o, const Lattice& lattice) {
    std::vector<LatticeWave> waves;
    const bool along_y = lattice.dimension == 2 && lattice.nx == lattice.ny;
    for (const int n : o.waves) {
        if (n < 1) {
            throw OptionError({.problem = "option 'scheme.waves' has a wrong value",
                               .actual = std::to_string(n),
                               .expected = "positive integers",
                               .suggestion = {}});
        }
        waves.push_back({n, 0});
        if (along_y) waves.push_back({0, n});
    }
    return waves;
}

// Below some 16384 cells a thread, waiting for one another costs more than it saves.
void choose_threads(int asked, FieldPlan& result, RunPlan& plan) {
    const Lattice& lattice = result.setup.lattice;
    const auto cells = static_cast<std::int64_t>(lattice.cells());
    const std::int64_t useful =
        lattice.dimension == 1 ? 1 : std::max<std::int64_t>(1, cells / 16384);
    const int offered = thread_count(0);  // more than the machine has would wait for one another
    result.threads = static_cast<int>(std::min<std::int64_t>({asked, useful, offered}));
    if (result.threads < std::min(asked, offered)) {
        plan.skip("threads beyond " + std::to_string(result.threads),
                  fmt::format("{} cells are too few to share", cells), "waiting of threads");
    }
}

void warn(const FieldPlan& result, RunPlan& plan) {
    const FieldSetup& setup = result.setup;
    if (setup.has_order &&
        OrderSpectrum(setup.lattice, setup.model, setup.dt, OrderScheme::exact, 0).diffuses()) {
        plan.warn("nu = 0: the mean of the order field diffuses, there is no stationary state");
    }
    if (setup.model.d0 == 0) {
        plan.warn("d0 = 0: the density only gathers noise, there is no stationary state");
    }
    const double smallest = 2 * std::numbers::pi /
                            (std::max(setup.lattice.nx, setup.lattice.ny) * setup.lattice.spacing);
    const double mean_d =
        setup.has_order
            ? setup.model.d0 /
                  std::sqrt(1 + 2 * setup.model.lambda * order_variance(setup.lattice, setup.model))
            : setup.model.d0;
    const double needed = 1 / (mean_d * smallest * smallest);
    const double relax = static_cast<double>(result.schedule.relax) * setup.dt;
    if (result.waves.empty() && mean_d > 0 && relax < needed) {
        plan.warn(
            fmt::format("the relaxation of {:.4g} is shorter than that of the longest wave, "
                        "1/(D k^2) = {:.3g}: S at the smallest k may not be stationary",
                        relax, needed));
    }
}

}  // namespace

FieldPlan plan_field(const FieldOptions& options, RunPlan& plan) {
    if (options.model.b % 2 != 0) {
        throw OptionError({.problem = "option 'model.b' has a wrong value",
                           .actual = fmt::format("{}", options.model.b),
                           .expected = "an even number",
                           .suggestion = "2 or 4, as in the paper"});
    }
    FieldPlan result;
    FieldSetup& setup = result.setup;
    setup.lattice = lattice_of(options.lattice);
    setup.model = options.model;
    setup.dt = options.scheme.dt;
    setup.replicas = options.record.replicas;
    setup.seed = options.seed;
    setup.has_order = options.model.lambda > 0;
    choose_scheme(options.scheme, result, plan);
    require_solvable(setup);
    if (setup.has_order) {
        plan.run("order field", setup.scheme == FieldScheme::paper
                                    ? "Crank-Nicolson modes, as published"
                                    : "exact Ornstein-Uhlenbeck modes, one inverse transform");
        choose_cut(options.scheme, setup, plan);
        choose_hold(options.scheme, setup, plan);
    } else {
        plan.skip("order field", "lambda = 0: D = D0", "all of its transforms");
    }
    choose_noise(options, setup, plan);
    if (options.scheme.scheme == SchemeChoice::adjoint) {
        result.waves = waves_of(options.scheme, setup.lattice);
        setup.replicas = 1;
    }
    result.schedule = schedule_of(options.record, setup.dt);
    require_steps(options.record, setup.dt, result.schedule, plan);
    choose_threads(options.threads, result, plan);
    warn(result, plan);
    return result;
}

}  // namespace grainfield::simulate
