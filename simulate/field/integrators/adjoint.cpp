#include "simulate/field/integrators/adjoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "simulate/field/integrators/field_engine.h"
#include "simulate/field/kernels/line_sweep.h"

namespace grainfield::simulate {

namespace {

double wavenumber_of(const Lattice& lattice, LatticeWave wave) {
    const double kx = 2 * std::numbers::pi * wave.nx / (lattice.nx * lattice.spacing);
    const double ky = 2 * std::numbers::pi * wave.ny / (lattice.ny * lattice.spacing);
    return std::hypot(kx, ky);
}

void require_waves(const FieldSetup& setup, const std::vector<LatticeWave>& waves) {
    const auto refuse = [](const std::string& actual, const std::string& expected) {
        throw OptionError({.problem = "the adjoint estimator cannot start",
                           .actual = actual,
                           .expected = expected,
                           .suggestion = {}});
    };
    if (!(setup.model.d0 > 0)) refuse("d0 = 0", "a positive d0, or its waves never decay");
    if (waves.empty()) refuse("no wavevectors", "at least one");
    for (const LatticeWave& wave : waves) {
        if (wave.nx == 0 && wave.ny == 0)
            refuse("the wavevector 0", "another one: mass is conserved");
        if (2 * std::abs(wave.nx) > setup.lattice.nx || 2 * std::abs(wave.ny) > setup.lattice.ny) {
            refuse(fmt::format("the wavevector ({}, {})", wave.nx, wave.ny),
                   fmt::format("at most ({}, {})", setup.lattice.nx / 2, setup.lattice.ny / 2));
        }
    }
}

}  // namespace

class AdjointEstimator::State {
 public:
    explicit State(std::vector<LatticeWave> list) : waves(std::move(list)), samples(waves.size()) {}
    virtual ~State() = default;
    virtual FieldIntegrator& fields() = 0;
    virtual void save(Checkpoint& checkpoint) const = 0;

    std::vector<LatticeWave> waves;
    std::vector<std::vector<double>> samples;
    // Per wave:
    std::vector<double> sum;           ///< of the stretch under way
    std::vector<std::int64_t> begin;   ///< its first step
    std::vector<std::int64_t> length;  ///< steps of a stretch; 0: the first one is under way
};

/// The densities of FieldEngine are here the real and imaginary parts of the φ of each wave.
template <class Real>
class AdjointEstimator::Engine : public AdjointEstimator::State, public FieldEngine<Real> {
 public:
    Engine(const FieldSetup& setup, std::vector<LatticeWave> list, int threads, double rest)
        : State(std::move(list)),
          FieldEngine<Real>(setup, OrderScheme::exact, threads),
          sweep_(sweep_of(setup)),
          rest_(rest) {
        sum.assign(waves.size(), 0);
        begin.assign(waves.size(), 0);
        length.assign(waves.size(), 0);
        for (std::size_t w = 0; w < waves.size(); ++w) start(w);
    }
    FieldIntegrator& fields() override { return *this; }
    void save(Checkpoint& checkpoint) const override { FieldEngine<Real>::save(checkpoint); }

 protected:
    using Array = typename FieldEngine<Real>::Array;
    void step(Team& team) override;

 private:
    static LineSweep<Real> sweep_of(const FieldSetup& setup) {
        const double dx2 = setup.lattice.spacing * setup.lattice.spacing;
        return {setup.lattice, setup.dt * setup.model.d0 / (2 * dx2), setup.dt / (4 * dx2), 0,
                AfterSolve::reflect};
    }
    void start(std::size_t wave);
    double square(std::size_t wave) const;
    void sweep(bool along_x, Team& team);

    LineSweep<Real> sweep_;
    double rest_;
};

template <class Real>
void AdjointEstimator::Engine<Real>::start(std::size_t wave) {
    const Lattice& lattice = this->lattice();
    const double size = 1 / std::sqrt(lattice.volume());
    const auto [n_x, n_y] = waves[wave];
    for (int y = 0; y < lattice.ny; ++y) {
        for (int x = 0; x < lattice.nx; ++x) {
            const double turns = static_cast<double>(n_x) * x / lattice.nx +
                                 static_cast<double>(n_y) * y / lattice.ny;
            const std::size_t i =
                static_cast<std::size_t>(y) * lattice.stride() + static_cast<std::size_t>(x);
            this->density_[2 * wave][i] =
                static_cast<Real>(size * std::cos(2 * std::numbers::pi * turns));
            this->density_[2 * wave + 1][i] =
                static_cast<Real>(size * std::sin(2 * std::numbers::pi * turns));
        }
    }
    sum[wave] = 0;
}

// ‖φ‖²
template <class Real>
double AdjointEstimator::Engine<Real>::square(std::size_t wave) const {
    double total = 0;
    for (const std::size_t part : {2 * wave, 2 * wave + 1}) {
        const Array& phi = this->density_[part];
        for (int y = 0; y < this->lattice().ny; ++y) {
            const Real* row = &phi[this->lattice().stride() * static_cast<std::size_t>(y)];
            for (int x = 0; x < this->lattice().nx; ++x) {
                total += static_cast<double>(row[x]) * static_cast<double>(row[x]);
            }
        }
    }
    return total * this->lattice().cell_volume();
}

template <class Real>
void AdjointEstimator::Engine<Real>::sweep(bool along_x, Team& team) {
    const Lattice& lattice = this->lattice();
    const int bundles =
        lattice.dimension == 1 ? 1 : sweep_.bundles(along_x ? lattice.ny : lattice.nx);
    const std::size_t parts = this->density_.size();
    std::vector<double> squares(static_cast<std::size_t>(bundles) * parts, 0);
    const typename LineSweep<Real>::Noise none;
    team.split(bundles, [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t b = first; b < last; ++b) {
            const std::span<double> own(&squares[static_cast<std::size_t>(b) * parts], parts);
            const auto bundle = static_cast<int>(b);
            if (lattice.dimension == 1) {
                sweep_.ring(this->mean_, this->density_, none, own);
            } else if (along_x) {
                sweep_.rows(bundle, this->mean_, this->density_, none, own);
            } else {
                sweep_.columns(bundle, this->mean_, this->density_, none, own);
            }
        }
    });
    const double scale = this->setup_.model.c1 * this->setup_.dt * lattice.cell_volume() /
                         (lattice.spacing * lattice.spacing);
    for (int b = 0; b < bundles; ++b) {
        for (std::size_t p = 0; p < parts; ++p) {
            sum[p / 2] += scale * squares[static_cast<std::size_t>(b) * parts + p];
        }
    }
}

template <class Real>
void AdjointEstimator::Engine<Real>::step(Team& team) {
    if (this->order_is_due()) {
        this->advance_order(team);
        team.split(this->row_blocks(), [this](std::int64_t first, std::int64_t last) {
            for (auto block = static_cast<int>(first); block < last; ++block) {
                this->average_diffusivity(block * OrderField<Real>::rows_at_once);
            }
        });
    }
    const bool x_first = this->step_ % 2 == 0;
    sweep(x_first || this->lattice().dimension == 1, team);
    if (this->lattice().dimension == 2) sweep(!x_first, team);
    const std::int64_t now = this->step_ + 1;
    constexpr std::int64_t between_looks = 8;
    for (std::size_t w = 0; w < waves.size(); ++w) {
        const std::int64_t taken = now - begin[w];
        if (length[w] == 0) {
            if (now % between_looks != 0 || square(w) > rest_) continue;
            length[w] = taken + taken / 2;
        } else {
            if (taken < length[w]) continue;
            samples[w].push_back(sum[w] / (1 - square(w)));
        }
        start(w);
        begin[w] = now;
    }
}

AdjointEstimator::AdjointEstimator(const FieldSetup& setup, std::vector<LatticeWave> waves,
                                   int threads, double rest) {
    require_waves(setup, waves);
    FieldSetup own = setup;
    own.replicas = 2 * static_cast<int>(waves.size());
    if (setup.twofold) {
        state_ = std::make_unique<Engine<double>>(own, std::move(waves), threads, rest);
    } else {
        state_ = std::make_unique<Engine<float>>(own, std::move(waves), threads, rest);
    }
}

AdjointEstimator::~AdjointEstimator() = default;
AdjointEstimator::AdjointEstimator(AdjointEstimator&&) noexcept = default;

void AdjointEstimator::advance(std::int64_t steps) {
    state_->fields().advance(steps);
}

std::int64_t AdjointEstimator::step() const {
    return state_->fields().step();
}

double AdjointEstimator::time() const {
    return state_->fields().time();
}

double AdjointEstimator::wavenumber(std::size_t wave) const {
    return wavenumber_of(state_->fields().setup().lattice, state_->waves.at(wave));
}

const std::vector<double>& AdjointEstimator::samples(std::size_t wave) const {
    return state_->samples.at(wave);
}

double AdjointEstimator::under_way(std::size_t wave) const {
    return state_->sum.at(wave);
}

std::size_t AdjointEstimator::waves() const {
    return state_->waves.size();
}

void AdjointEstimator::save(Checkpoint& checkpoint) const {
    state_->fields().save(checkpoint);
    checkpoint.kind = "field adjoint";
    checkpoint.reals["adjoint sum"] = state_->sum;
    checkpoint.integers["adjoint begin"] = state_->begin;
    checkpoint.integers["adjoint length"] = state_->length;
    for (std::size_t w = 0; w < waves(); ++w) {
        checkpoint.reals[fmt::format("adjoint samples {}", w)] = state_->samples[w];
    }
}

void AdjointEstimator::restore(const Checkpoint& checkpoint) {
    const auto has = [this](const auto& arrays, const char* name) {
        const auto found = arrays.find(name);
        return found != arrays.end() && found->second.size() == waves();
    };
    if (checkpoint.kind != "field adjoint" || !has(checkpoint.reals, "adjoint sum") ||
        !has(checkpoint.integers, "adjoint begin") || !has(checkpoint.integers, "adjoint length")) {
        throw InputError("the checkpoint is not one of these wavevectors.");
    }
    Checkpoint fields = checkpoint;
    fields.kind = "field";
    state_->fields().restore(fields);
    for (std::size_t w = 0; w < waves(); ++w) {
        const std::int64_t begin = checkpoint.integers.at("adjoint begin")[w];
        const std::int64_t length = checkpoint.integers.at("adjoint length")[w];
        if (begin < 0 || begin > step() || length < 0 ||
            !std::isfinite(checkpoint.reals.at("adjoint sum")[w])) {
            throw InputError(
                fmt::format("the checkpoint does not fit: wavevector {} began at step {} of {}.", w,
                            begin, step()));
        }
    }
    state_->sum = checkpoint.reals.at("adjoint sum");
    state_->begin = checkpoint.integers.at("adjoint begin");
    state_->length = checkpoint.integers.at("adjoint length");
    for (std::size_t w = 0; w < waves(); ++w) {
        const auto found = checkpoint.reals.find(fmt::format("adjoint samples {}", w));
        state_->samples[w] =
            found == checkpoint.reals.end() ? std::vector<double>{} : found->second;
    }
}

}  // namespace grainfield::simulate
