// Where integrators stall, skip contacts, lose digits or blow up, beside the way one would write
// them down. Prints plot,series,x,y.
//   bench.stability.simulate [periods] [plate] [restitution] [loss] [step] [nu] [exponent] [edge]
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "bench/stability/rows.h"
#include "core/errors.h"
#include "core/support/random.h"
#include "simulate/field/integrators/explicit_integrator.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "simulate/field/model/diffusivity.h"
#include "simulate/field/model/order_spectrum.h"
#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/mechanics/collision_rule.h"
#include "simulate/md/mechanics/plate_time.h"
#include "simulate/md/state/initial_state.h"
#include "tests/simulate/md/engine/reference_engine.h"

using namespace grainfield;
using namespace grainfield::simulate;
using grainfield::bench::print_row;

namespace {

using Wide = long double;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

MdOptions small_layer(std::int64_t grains, double side) {
    MdOptions options;
    options.cell.grains = grains;
    options.cell.length_x = options.cell.length_y = side;
    return options;
}

// ---- a million periods ----

/// Depth of contacts, as a length [a].
double deepest(const Ledger& ledger) {
    return std::max(ledger.deepest_pair.depth / 2, ledger.deepest_plate.depth);
}

void many_periods() {
    constexpr double most = 1e6;
    const MdOptions options = small_layer(6, 3);
    const MdSystem system = options.system();
    const double period = system.period();
    const GrainState start = make_initial_state(options, 1);
    // One window as long as the run: times count from its beginning.
    const auto absolute = make_engine(system, {});
    absolute->load(start, most * period);
    for (double periods = 1; periods <= most; periods *= 10) {
        absolute->advance(periods * period);
        print_row("periods", "naive, times from the beginning of the run", periods,
                  deepest(absolute->ledger()));
    }
    // Windows of ten periods at most, as simulate md has them.
    const auto windows = make_engine(system, {});
    GrainState state = start;
    double done = 0, depth = 0;
    for (double periods = 1; periods <= most; periods *= 10) {
        while (done < periods) {
            const double length = std::min(10.0, periods - done);
            windows->load(state, length * period);
            windows->advance(length * period);
            windows->store(length * period, state);
            depth = std::max(depth, deepest(windows->ledger()));
            done += length;
        }
        print_row("periods", "ours, times from the beginning of the window", periods, depth);
    }
}

// ---- the next contact with a plate that throws as hard as gravity pulls ----

struct Flight {
    Wide z, v, t;      // of the lowest point, at t
    Wide a, omega, g;  // A, ω, g

    Wide gap(Wide tau) const {
        return z + v * tau - g * tau * tau / 2 - a * sinl(omega * (t + tau));
    }
    Wide curvature_bound() const { return g + a * omega * omega; }
};

/// The first τ in (low, high) with gap ≤ 0, to 1e-16, or −1. Halves whatever the bound on the
/// curvature does not exclude.
Wide first_contact(const Flight& f, Wide low, Wide gap_low, Wide high, Wide gap_high) {
    const Wide width = high - low;
    if (gap_low > 0 && gap_high > 0) {
        if (std::min(gap_low, gap_high) > f.curvature_bound() * width * width / 8) return -1;
    }
    if (width < 1e-16L) return gap_high <= 0 ? high : -1;
    const Wide middle = low + width / 2;
    const Wide gap_middle = f.gap(middle);
    const Wide left = first_contact(f, low, gap_low, middle, gap_middle);
    if (left >= 0) return left;
    if (gap_middle <= 0) return middle;
    return first_contact(f, middle, gap_middle, high, gap_high);
}

/// Newton's iteration from τ = `start`; −1: it does not settle between 0 and `limit`.
double newton_contact(const Flight& f, double start, double limit) {
    const auto z = static_cast<double>(f.z), v = static_cast<double>(f.v);
    const auto a = static_cast<double>(f.a), omega = static_cast<double>(f.omega);
    const auto t = static_cast<double>(f.t), g = static_cast<double>(f.g);
    double tau = start;
    for (int i = 0; i < 100; ++i) {
        const double phase = omega * (t + tau);
        const double gap = z + v * tau - 0.5 * g * tau * tau - a * std::sin(phase);
        const double rate = v - g * tau - a * omega * std::cos(phase);
        const double next = tau - gap / rate;
        if (!std::isfinite(next)) return -1;
        if (std::abs(next - tau) < 1e-14) return next > 0 && next < limit ? next : -1;
        tau = next;
    }
    return -1;
}

void grazed_plate() {
    constexpr int flights = 4000;
    for (int half = 0; half <= 8; ++half) {
        const double excess = std::pow(10.0, -0.5 * half);  // Γ − 1
        RandomStream random(1, "stability plate");
        int from_start = 0, from_parabola = 0, ours = 0;
        double worst_gap = 0;
        for (int i = 0; i < flights; ++i) {
            MdSystem system;
            system.angular_frequency = 5;
            system.amplitude = (1 + excess) / 25;
            system.length.z = 1e3;
            // Hops: just off the plate, when it falls nearly as fast as the grain.
            Grain grain;
            grain.t = (std::numbers::pi / 2 + 0.3 * random.normal()) / 5 + 2 * system.period();
            const double gap = std::pow(10.0, random.uniform(-12, -4));
            const double rate = std::pow(10.0, random.uniform(-6, -2));
            grain.r.z = system.amplitude * std::sin(5 * grain.t) + gap;
            grain.v.z = 5 * system.amplitude * std::cos(5 * grain.t) + rate;
            const Flight flight{grain.r.z, grain.v.z, grain.t, system.amplitude, 5, 1};
            grain.r.z += 0.5;
            const double limit = 2 * system.period();
            const Wide truth = first_contact(flight, 0, flight.gap(0), limit, flight.gap(limit));
            const auto is_wrong = [&](double tau) {
                if (truth < 0) return tau >= 0;
                return tau < 0 || std::abs(tau - static_cast<double>(truth)) > 1e-6;
            };
            from_start += is_wrong(newton_contact(flight, 0, limit));
            // How fast the grain falls towards the plate as the latter moves now.
            const double fall = 1 - 25 * system.amplitude * std::sin(5 * grain.t);
            const double parabola = (rate + std::sqrt(rate * rate + 2 * fall * gap)) / fall;
            from_parabola +=
                is_wrong(std::isfinite(parabola) ? newton_contact(flight, parabola, limit) : -1);
            const PlateSolver solver(system);
            const auto hit = solver.first_hit<Plates::vibrating, true>(grain, grain.t + limit);
            const double tau = hit.time < never ? hit.time - grain.t : -1;
            ours += is_wrong(tau);
            if (tau >= 0) {
                worst_gap = std::max(worst_gap, std::abs(static_cast<double>(flight.gap(tau))));
            }
        }
        const auto share = [](int wrong) { return static_cast<double>(wrong) / flights; };
        print_row("plate", "naive, Newton from the beginning of the flight", excess,
                  share(from_start));
        print_row("plate", "naive, Newton from the parabola of the beginning", excess,
                  share(from_parabola));
        print_row("plate", "ours, steps by a bound on the curvature", excess, share(ours));
        print_row("gap", "ours, gap at the contact", excess, worst_gap);
    }
}

// ---- restitution ----

void restitution() {
    constexpr double periods = 20;
    for (const double e : {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.998, 1.0}) {
        MdOptions options = small_layer(12, 3.5);
        options.grain.restitution = options.plate.restitution = e;
        const double period = options.system().period();
        const double end = periods * period;
        // A plain event loop: whatever comes next, for 2e5 events.
        ReferenceEngine plain(options.system(), make_initial_state(options, 1), end);
        constexpr std::int64_t most = 100'000;
        double reached = periods;
        std::int64_t events = 0;
        while (plain.step()) {
            if (++events < most) continue;
            reached = plain.time() / period;
            break;
        }
        print_row("restitution", "naive, event after event, 100,000 of them", e, reached);
        for (const double contact_time : {0.0, 1e-4}) {
            options.run.contact_time = contact_time;
            const GrainState state = make_initial_state(options, 1);
            const auto engine = make_engine(options.system(), {});
            engine->load(state, end);
            const double before = engine->energies(0).total();
            double time = 0;
            bool is_reported = false;
            try {
                for (int i = 1; i <= 200 * periods; ++i) {
                    engine->advance(i * end / (200 * periods));
                    time = i / 200.0;
                }
            } catch (const PhysicsError&) {
                is_reported = true;
            }
            if (contact_time == 0) {
                print_row("restitution", is_reported ? "ours, reported, exit code 5" : "ours, done",
                          e, time);
                continue;
            }
            print_row("restitution",
                      is_reported ? "ours, contact time, reported" : "ours, contact time 1e-4", e,
                      time);
            if (is_reported) continue;
            const Ledger& ledger = engine->ledger();
            const double change = engine->energies(end).total() - before;
            const double losses = ledger.pair_loss.value() + ledger.plate_loss.value();
            const double work = ledger.work.value();
            print_row("energy", "ours, energy audit", e,
                      std::abs(change + losses - work) / (std::abs(before) + std::abs(work)));
        }
    }
}

/// Loss of one head-on collision of two grains.
void loss() {
    for (int half = 0; half <= 30; half += 2) {
        const double e = 1 - std::pow(10.0, -0.5 * half);
        RandomStream random(1, "stability loss");
        double ours = 0, naive = 0;
        for (int i = 0; i < 1000; ++i) {
            const Vec3 n{1, 0, 0};
            const Vec3 v1{random.normal(), random.normal(), random.normal()};
            Vec3 v2{random.normal(), random.normal(), random.normal()};
            v2.x = v1.x + std::abs(v2.x) + 0.1;
            ContactLaw law;
            law.restitution = e;
            const Impulse impulse = impulse_of<Tangential::smooth>(n, v1 - v2, 0.5, e, law);
            const Wide un = static_cast<Wide>(v1.x) - static_cast<Wide>(v2.x);
            const Wide truth =
                0.25L * (1 - static_cast<Wide>(e)) * (1 + static_cast<Wide>(e)) * un * un;
            const double before = 0.5 * squared_norm(v1) + 0.5 * squared_norm(v2);
            const double after =
                0.5 * squared_norm(v1 + impulse.j) + 0.5 * squared_norm(v2 - impulse.j);
            const auto error = [&](double loss) {
                return std::abs(static_cast<double>(loss / truth - 1));
            };
            ours = std::max(ours, error(impulse.loss));
            naive = std::max(naive, error(before - after));
        }
        print_row("loss", "ours, closed form", 1 - e, ours);
        print_row("loss", "naive, energy before less energy after", 1 - e, naive);
    }
}

// ---- the field model ----

FieldSetup field_setup(FieldScheme scheme, double dt, double nu, double lambda) {
    FieldSetup setup;
    setup.lattice = {2, 64, 64, 0.65};
    setup.scheme = scheme;
    setup.dt = dt;
    setup.twofold = true;
    setup.model.nu = nu;
    setup.model.lambda = lambda;
    setup.has_order = lambda > 0;
    setup.k_cut = 1e9;
    return setup;
}

double mean_square(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return sum / static_cast<double>(values.size());
}

/// Mean over samples of ⟨ρ²⟩ dx², until it is not finite.
double variance_of(FieldIntegrator& fields, double time, double sample) {
    const double cell = fields.setup().lattice.cell_volume();
    const auto steps = std::max<std::int64_t>(1, std::lround(sample / fields.setup().dt));
    double sum = 0;
    int samples = 0;
    while (fields.time() < time) {
        fields.advance(steps);
        const double now = mean_square(fields.density(0).value) * cell;
        if (!std::isfinite(now)) return std::numeric_limits<double>::infinity();
        if (fields.time() < time / 4) continue;
        sum += now;
        ++samples;
    }
    return sum / samples;
}

/// Euler–Maruyama, D from the same ψ as the program's own.
double euler_variance(const FieldSetup& setup, double time, double sample) {
    const int n = setup.lattice.nx;
    const double dx = setup.lattice.spacing, dt = setup.dt;
    // Its density is not looked at: it carries ψ.
    FieldSetup carrier = setup;
    carrier.scheme = FieldScheme::lod;
    const auto path = make_integrator(carrier, 1);
    std::vector<double> rho = path->density(0).value, next = rho;
    std::vector<double> d(rho.size(), setup.model.d0);
    const auto at = [n](int x, int y) {
        return static_cast<std::size_t>((y + n) % n * n + (x + n) % n);
    };
    const double strength = std::sqrt(setup.model.c1 * dt) / (dx * dx);
    const auto samples_every = std::max<std::int64_t>(1, std::lround(sample / dt));
    RandomStream random(1, "stability Euler");
    std::vector<double> face_x(rho.size()), face_y(rho.size());
    double sum = 0;
    int samples = 0;
    for (std::int64_t step = 0; static_cast<double>(step) * dt < time; ++step) {
        if (setup.has_order) {
            d = path->order().value;
            for (double& value : d) value = std::exp(-setup.model.lambda * value * value);
            path->advance(1);
        }
        for (std::size_t i = 0; i < rho.size(); ++i) {
            face_x[i] = strength * random.normal();
            face_y[i] = strength * random.normal();
        }
        const double h = dt / (2 * dx * dx);
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                const std::size_t i = at(x, y);
                double change = face_x[i] - face_x[at(x - 1, y)] + face_y[i] - face_y[at(x, y - 1)];
                for (const std::size_t j :
                     {at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)}) {
                    change += h * (d[i] + d[j]) * (rho[j] - rho[i]);
                }
                next[i] = rho[i] + change;
            }
        }
        rho.swap(next);
        const double now = mean_square(rho) * dx * dx;
        if (!std::isfinite(now) || now > 1e100) return std::numeric_limits<double>::infinity();
        if ((step + 1) % samples_every != 0 || static_cast<double>(step) * dt < time / 4) continue;
        sum += now;
        ++samples;
    }
    return sum / samples;
}

/// Constant D: ⟨ρ²⟩ dx² = C1/2D0 exactly.
void edge_of_stability() {
    const FieldSetup any = field_setup(FieldScheme::lod, 1, 0.01, 0);
    const double edge = ExplicitIntegrator<double>::largest_step(any.lattice, any.model.d0);
    const double exact = 0.5 * (1 - 1.0 / static_cast<double>(any.lattice.cells()));
    for (const double ratio : {0.1, 0.2, 0.5, 0.8, 0.9, 0.95, 0.98, 0.999, 1.001, 1.02, 1.05, 1.1,
                               1.3, 2.0, 5.0, 10.0, 30.0, 100.0}) {
        const double dt = ratio * edge;
        const double time = std::max(60.0, 1500 * dt);
        const auto error = [&](double variance) { return std::abs(variance / exact - 1); };
        const auto run = [&](FieldScheme scheme) {
            const auto fields = make_integrator(field_setup(scheme, dt, 0.01, 0), 1);
            return error(variance_of(*fields, time, std::max(0.2, dt)));
        };
        print_row("edge", "ours, LOD", ratio, run(FieldScheme::lod));
        print_row("edge", "as published, Peaceman–Rachford ADI", ratio, run(FieldScheme::paper));
        try {
            print_row("edge", "ours, explicit", ratio, run(FieldScheme::explicit_lm));
        } catch (const OptionError&) {
            print_row("edge", "ours, explicit, refused", ratio, nan);
        }
        print_row("edge", "naive, Euler", ratio,
                  error(euler_variance(field_setup(FieldScheme::lod, dt, 0.01, 0), time,
                                       std::max(0.2, dt))));
    }
}

/// D(ψ), ν = 0.01: ⟨ρ²⟩ dx², all steps on one path of ψ.
void long_steps() {
    constexpr double nu = 0.01, time = 2000, fine = 0.05;
    const auto setup = [](FieldScheme scheme, double dt) {
        FieldSetup s = field_setup(scheme, dt, nu, 1);
        s.substeps = static_cast<int>(std::lround(dt / fine));
        return s;
    };
    const auto run = [&](FieldScheme scheme, double dt) {
        const auto fields = make_integrator(setup(scheme, dt), 1);
        return variance_of(*fields, time, std::max(5.0, dt));
    };
    for (const double dt : {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
        print_row("step", "ours, LOD", dt, run(FieldScheme::lod, dt));
        print_row("step", "as published, Peaceman–Rachford ADI", dt, run(FieldScheme::paper, dt));
        print_row("step", "naive, Euler", dt,
                  euler_variance(setup(FieldScheme::lod, dt), time / 2, std::max(5.0, dt)));
    }
}

/// The variance that one-step coefficients in single precision leave to the slowest mode, g = ν.
void slow_order() {
    constexpr double dt = 0.5;
    for (int half = 2; half <= 26; ++half) {
        ModelOptions model;
        model.nu = std::pow(10.0, -0.5 * half);
        const Lattice lattice{2, 64, 64, 0.65};
        const OrderSpectrum spectrum(lattice, model, dt, OrderScheme::exact, 1e9);
        const Wide truth = static_cast<Wide>(model.c2) /
                           (2 * static_cast<Wide>(model.nu) * static_cast<Wide>(lattice.volume()));
        // c ← c − λc + βζ leaves β²/(λ(2 − λ)).
        const Wide loss = static_cast<float>(spectrum.loss(0)[0]);
        const Wide beta = static_cast<float>(spectrum.amplitude(0)[0]);
        const auto error = [&](Wide variance) {
            return std::abs(static_cast<double>(variance / truth - 1));
        };
        print_row("nu", "ours, loss 1 − α kept", model.nu,
                  error(beta * beta / (loss * (2 - loss))));
        const Wide alpha = static_cast<float>(std::exp(-model.nu * dt));
        print_row("nu", "naive, α kept", model.nu,
                  error(beta * beta / ((1 - alpha) * (1 + alpha))));
    }
}

/// exp(x) = 2^n p(f) with n put into the exponent bits, as vector code has it, without a range.
float exp_by_bits(float x) {
    const float scaled = x * 1.44269504f;
    const float n = std::nearbyint(scaled);
    const float f = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    float p = 1.0f / 720;
    for (const float c : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) p = p * f + c;
    const std::int32_t bits = (static_cast<std::int32_t>(n) + 127) * (1 << 23);
    float power = 0;
    std::memcpy(&power, &bits, sizeof power);
    return power * p;
}

/// |D − D0 exp(−λψ²)|/D0 in single precision.
void large_exponents() {
    for (double x = 0.01; x < 1300; x *= 1.3) {
        const auto psi = static_cast<float>(std::sqrt(x));
        const Wide truth = expl(-static_cast<Wide>(psi) * static_cast<Wide>(psi));
        float d = 0;
        diffusivities<float>({DiffusivityForm::exponential, 1, 1}, &psi, &d, 1);
        const auto error = [&](float value) {
            return std::abs(static_cast<double>(static_cast<Wide>(value) - truth));
        };
        print_row("exponent", "ours", x, error(d));
        print_row("exponent", "naive, exponent bits without a range", x,
                  error(exp_by_bits(-psi * psi)));
    }
}

}  // namespace

int main(int argc, char** argv) {
    return bench::print_plots(argc, argv,
                              {{"periods", many_periods},
                               {"plate", grazed_plate},
                               {"restitution", restitution},
                               {"loss", loss},
                               {"step", long_steps},
                               {"nu", slow_order},
                               {"exponent", large_exponents},
                               {"edge", edge_of_stability}});
}
