#include "simulate/field/integrators/field_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::simulate {

namespace {

constexpr std::uint32_t initial_line = 0xFFFFFFFFU;
constexpr std::int64_t most_steps = std::int64_t{1} << 53;  // a double counts as far

[[noreturn]] void refuse(const std::string& actual, const std::string& expected) {
    throw InputError({.problem = "the checkpoint cannot be used",
                      .actual = actual,
                      .expected = expected,
                      .suggestion = "start again without option 'resume'"});
}

const std::vector<double>& finite_numbers(const Checkpoint& checkpoint, const std::string& name,
                                          std::size_t count) {
    const auto found = checkpoint.reals.find(name);
    if (found == checkpoint.reals.end()) refuse(fmt::format("it has no '{}'", name), {});
    if (found->second.size() != count) {
        refuse(fmt::format("'{}' has {} numbers", name, found->second.size()),
               fmt::format("{}", count));
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (std::isfinite(found->second[i])) continue;
        refuse(fmt::format("'{}' holds {} at position {}", name, found->second[i], i),
               "finite numbers");
    }
    return found->second;
}

double k_cut_of(const FieldSetup& setup) {
    return setup.has_order ? setup.k_cut : 0;
}

}  // namespace

template <class Real>
FieldEngine<Real>::FieldEngine(const FieldSetup& setup, OrderScheme order_scheme, int threads)
    : setup_(setup),
      threads_(setup.lattice.dimension == 1 ? 1 : threads),
      order_(setup.lattice,
             OrderSpectrum(setup.lattice, setup.model, setup.dt * setup.hold / setup.substeps,
                           order_scheme, k_cut_of(setup)),
             setup.seed),
      law_(DiffusivityLaw::of(setup.model,
                              setup.has_order ? order_.spectrum().missing_variance() : 0)),
      diffusivity_(setup.lattice.padded_cells(), static_cast<Real>(setup.model.d0)),
      mean_(diffusivity_) {
    for (int replica = 0; replica < setup.replicas; ++replica) {
        noise_.emplace_back(setup.seed, "density noise", static_cast<std::uint64_t>(replica));
        density_.emplace_back(lattice().padded_cells(), Real{0});
        draw_density(replica);
    }
    if (!setup_.has_order) return;
    order_.draw_stationary();
    on_team(threads_, [this](Team& team) {
        order_.transform_columns(team);
        refresh_diffusivity(team);
    });
}

template <class Real>
void FieldEngine<Real>::refresh_diffusivity(Team& team) {
    team.split(row_blocks(), [this](std::int64_t first_block, std::int64_t last_block) {
        constexpr int block = OrderField<Real>::rows_at_once;
        thread_local AlignedVector<Real> rows;
        rows.resize(lattice().stride() * block);
        for (auto b = static_cast<int>(first_block); b < last_block; ++b) {
            const int first = b * block;
            read_diffusivity(first, rows.data());
            const int count = std::min(block, lattice().ny - first);
            std::copy_n(rows.data(), lattice().stride() * static_cast<std::size_t>(count),
                        &diffusivity_[lattice().stride() * static_cast<std::size_t>(first)]);
        }
    });
}

template <class Real>
void FieldEngine<Real>::advance_order(Team& team) {
    const auto done = static_cast<std::uint64_t>(step_ / setup_.hold);
    const auto substeps = static_cast<std::uint64_t>(setup_.substeps);
    for (std::uint64_t i = 1; i <= substeps; ++i) order_.advance(done * substeps + i, team);
}

template <class Real>
void FieldEngine<Real>::average_diffusivity(int first) {
    const std::size_t stride = lattice().stride();
    const int rows = std::min(OrderField<Real>::rows_at_once, lattice().ny - first);
    thread_local AlignedVector<Real> next;
    next.resize(stride * OrderField<Real>::rows_at_once);
    read_diffusivity(first, next.data());
    Real* now = &diffusivity_[stride * static_cast<std::size_t>(first)];
    Real* mean = &mean_[stride * static_cast<std::size_t>(first)];
    const std::size_t count = stride * static_cast<std::size_t>(rows);
    for (std::size_t i = 0; i < count; ++i) {
        mean[i] = Real{0.5} * (now[i] + next[i]);
        now[i] = next[i];
    }
}

template <class Real>
void FieldEngine<Real>::draw_density(int replica) {
    const ModelOptions& model = setup_.model;
    if (!(model.d0 > 0)) return;  // no stationary state: start flat
    const double deviation = std::sqrt(model.c1 / (2 * model.d0 * lattice().cell_volume()));
    const auto nx = static_cast<std::size_t>(lattice().nx);
    std::vector<float> white(lattice().cells());
    noise_[static_cast<std::size_t>(replica)].normal(initial_line, initial_line, white);
    double mean = 0;
    for (float x : white) mean += static_cast<double>(x);
    mean /= static_cast<double>(white.size());
    for (std::size_t i = 0; i < white.size(); ++i) {
        density_[static_cast<std::size_t>(replica)][i / nx * lattice().stride() + i % nx] =
            static_cast<Real>(deviation * (static_cast<double>(white[i]) - mean));
    }
}

template <class Real>
void FieldEngine<Real>::advance(std::int64_t steps) {
    on_team(threads_, [&](Team& team) {
        for (std::int64_t i = 0; i < steps; ++i) {
            step(team);
            ++step_;
        }
    });
}

template <class Real>
void FieldEngine<Real>::read_diffusivity(int first, Real* out) const {
    thread_local typename OrderField<Real>::Scratch scratch(lattice());
    if (scratch.nx != lattice().nx) scratch = typename OrderField<Real>::Scratch(lattice());
    order_.read_rows(first, scratch, out);
    const int rows = std::min(OrderField<Real>::rows_at_once, lattice().ny - first);
    diffusivities(law_, out, out, lattice().stride() * static_cast<std::size_t>(rows));
}

template <class Real>
void FieldEngine<Real>::fill_noise(int replica, std::uint32_t line, std::span<float> out) const {
    const NoiseStream& stream = noise_[static_cast<std::size_t>(replica)];
    const auto now = static_cast<std::uint64_t>(step_);
    if (setup_.noise == NoiseShape::normal) {
        stream.normal(now, line, out);
    } else {
        stream.uniform(now, line, out);
    }
}

template <class Real>
double FieldEngine<Real>::noise_strength() const {
    return std::sqrt(setup_.model.c1 * setup_.dt / lattice().cell_volume()) / lattice().spacing;
}

template <class Real>
DensityField FieldEngine<Real>::field_of(const Array& array) const {
    DensityField field;
    field.step = step_;
    field.time = time();
    field.nx = lattice().nx;
    field.ny = lattice().ny;
    field.spacing = lattice().spacing;
    field.value = plain(array);
    return field;
}

template <class Real>
std::vector<double> FieldEngine<Real>::plain(const Array& array) const {
    std::vector<double> values;
    values.reserve(lattice().cells());
    for (int y = 0; y < lattice().ny; ++y) {
        const Real* row = &array[lattice().stride() * static_cast<std::size_t>(y)];
        for (int x = 0; x < lattice().nx; ++x) values.push_back(static_cast<double>(row[x]));
    }
    return values;
}

template <class Real>
DensityField FieldEngine<Real>::density(int replica) const {
    return field_of(density_[static_cast<std::size_t>(replica)]);
}

template <class Real>
DensityField FieldEngine<Real>::order() const {
    constexpr int block = OrderField<Real>::rows_at_once;
    Array psi(lattice().stride() *
              static_cast<std::size_t>((lattice().ny + block - 1) / block * block));
    if (setup_.has_order) {
        typename OrderField<Real>::Scratch scratch(lattice());
        for (int first = 0; first < lattice().ny; first += block) {
            order_.read_rows(first, scratch,
                             &psi[lattice().stride() * static_cast<std::size_t>(first)]);
        }
    }
    return field_of(psi);
}

template <class Real>
double FieldEngine<Real>::mean_diffusivity() const {
    double sum = 0;
    for (double d : plain(diffusivity_)) sum += d;
    return sum / static_cast<double>(lattice().cells());
}

template <class Real>
double FieldEngine<Real>::mass(int replica) const {
    double sum = 0;
    for (double rho : plain(density_[static_cast<std::size_t>(replica)])) sum += rho;
    return sum * lattice().cell_volume();
}

template <class Real>
void FieldEngine<Real>::save(Checkpoint& checkpoint) const {
    checkpoint.kind = "field";
    checkpoint.integers["step"] = {step_};
    checkpoint.reals["order"] = order_.modes();
    checkpoint.reals["diffusivity"] = plain(diffusivity_);
    for (std::size_t r = 0; r < density_.size(); ++r) {
        checkpoint.reals[fmt::format("density {}", r)] = plain(density_[r]);
    }
    if (setup_.hold > 1) checkpoint.reals["mean diffusivity"] = plain(mean_);
}

template <class Real>
void FieldEngine<Real>::take(const Checkpoint& checkpoint, const std::string& name,
                             Array& array) const {
    const auto& values = finite_numbers(checkpoint, name, lattice().cells());
    const auto nx = static_cast<std::size_t>(lattice().nx);
    constexpr double most = static_cast<double>(std::numeric_limits<Real>::max());
    if (std::ranges::any_of(values, [](double value) { return std::abs(value) > most; })) {
        refuse(fmt::format("'{}' holds a number that is too large", name), {});
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        array[i / nx * lattice().stride() + i % nx] = static_cast<Real>(values[i]);
    }
}

template <class Real>
void FieldEngine<Real>::restore(const Checkpoint& checkpoint) {
    if (checkpoint.kind != "field") {
        refuse(fmt::format("it is of kind '{}'", checkpoint.kind), "kind 'field'");
    }
    const auto at = checkpoint.integers.find("step");
    if (at == checkpoint.integers.end() || at->second.size() != 1 || at->second[0] < 0 ||
        at->second[0] > most_steps) {
        refuse("it has no step", {});
    }
    order_.set_modes(finite_numbers(checkpoint, "order", order_.modes().size()));
    on_team(threads_, [this](Team& team) { order_.transform_columns(team); });
    take(checkpoint, "diffusivity", diffusivity_);
    for (std::size_t r = 0; r < density_.size(); ++r) {
        take(checkpoint, fmt::format("density {}", r), density_[r]);
    }
    if (setup_.hold > 1) take(checkpoint, "mean diffusivity", mean_);
    step_ = at->second[0];
}

template <class Real>
std::size_t FieldEngine<Real>::memory() const {
    const std::size_t columns = static_cast<std::size_t>(order_.spectrum().columns());
    const int room = lattice().ny == 1 ? 0 : 16;  // so far columns are apart
    const std::size_t modes = columns * static_cast<std::size_t>(lattice().ny + room);
    // Fields: ρ, D and one more of the scheme; modes: c, transform, decay, amplitude, tables.
    return lattice().padded_cells() * sizeof(Real) * (density_.size() + 2) +
           modes * (8 * sizeof(Real) + 3 * sizeof(double) / 2);
}

template class FieldEngine<float>;
template class FieldEngine<double>;

}  // namespace grainfield::simulate
