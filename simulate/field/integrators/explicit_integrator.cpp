#include "simulate/field/integrators/explicit_integrator.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "simulate/field/kernels/row_noise_window.h"

namespace grainfield::simulate {

template <class Real>
double ExplicitIntegrator<Real>::largest_step(const Lattice& lattice, double d0) {
    if (!(d0 > 0)) return std::numeric_limits<double>::infinity();
    return lattice.spacing * lattice.spacing / (2 * lattice.dimension * d0);
}

template <class Real>
ExplicitIntegrator<Real>::ExplicitIntegrator(const FieldSetup& setup, int threads)
    : FieldEngine<Real>(setup, OrderScheme::exact, threads), next_(setup.lattice.padded_cells()) {
    const double bound = largest_step(setup.lattice, setup.model.d0);
    if (setup.dt < bound) return;
    throw OptionError(
        {.problem = "the explicit scheme is unstable at this time step",
         .actual = fmt::format("dt = {:g}", setup.dt),
         .expected = fmt::format("below dx^2/({} D0) = {:.4g}", 2 * setup.lattice.dimension, bound),
         .suggestion = "take a smaller step, or scheme = \"lod\""});
}

template <class Real>
void ExplicitIntegrator<Real>::advance_rows(int replica, int first, int last) {
    const Lattice& lattice = this->lattice();
    const std::size_t stride = lattice.stride();
    const int ny = lattice.ny;
    const Array& rho = this->density_[static_cast<std::size_t>(replica)];
    const auto row = [&](const Array& array, int y) {
        return &array[stride * static_cast<std::size_t>((y + ny) % ny)];
    };
    const RowNoiseWindow::Fill fill = [&](std::uint32_t line, std::span<float> out) {
        this->fill_noise(replica, line, out);
    };
    RowNoiseWindow noise(lattice.nx, ny, lattice.dimension, fill);
    const auto s = static_cast<Real>(this->noise_strength() / 2);
    const auto h = static_cast<Real>(this->setup_.dt / (2 * lattice.spacing * lattice.spacing));
    thread_local std::array<AlignedVector<Real>, 3> z;
    for (auto& one : z) one.resize(stride);
    const auto draw = [&](int y, AlignedVector<Real>& to) {
        add_row_noise(row(rho, y), noise.at(y), s, lattice.nx, to.data());
    };
    const bool flat = ny == 1;
    if (!flat) draw(first - 1, z[0]);
    draw(first, z[1]);
    for (int y = first; y < last; ++y) {
        if (!flat) draw(y + 1, z[2]);
        const RowStencil<Real> around =
            flat ? RowStencil<Real>{z[1].data(), z[1].data(), z[1].data()}
                 : RowStencil<Real>{z[0].data(), z[1].data(), z[2].data()};
        const RowStencil<Real> d{row(this->mean_, y - 1), row(this->mean_, y),
                                 row(this->mean_, y + 1)};
        Real* out = &next_[stride * static_cast<std::size_t>(y)];
        reflect_row(z[1].data(), row(rho, y), lattice.nx, out);
        add_row_diffusion(out, around, d, h, flat ? Real{0} : h, lattice.nx, out);
        std::rotate(z.begin(), z.begin() + 1, z.end());
    }
}

template <class Real>
void ExplicitIntegrator<Real>::step(Team& team) {
    if (this->order_is_due()) {
        this->advance_order(team);
        team.split(this->row_blocks(), [this](std::int64_t first, std::int64_t last) {
            for (auto block = static_cast<int>(first); block < last; ++block) {
                this->average_diffusivity(block * OrderField<Real>::rows_at_once);
            }
        });
    }
    for (int replica = 0; replica < this->setup_.replicas; ++replica) {
        team.split(this->lattice().ny, [&](std::int64_t first, std::int64_t last) {
            advance_rows(replica, static_cast<int>(first), static_cast<int>(last));
        });
        next_.swap(this->density_[static_cast<std::size_t>(replica)]);
    }
}

template <class Real>
DensityField ExplicitIntegrator<Real>::density(int replica) const {
    const Lattice& lattice = this->lattice();
    const RowNoiseWindow::Fill fill = [&](std::uint32_t line, std::span<float> out) {
        this->fill_noise(replica, line, out);
    };
    RowNoiseWindow noise(lattice.nx, lattice.ny, lattice.dimension, fill);
    const auto s = static_cast<Real>(this->noise_strength() / 2);
    Array z(lattice.padded_cells());
    for (int y = 0; y < lattice.ny; ++y) {
        const std::size_t begin = lattice.stride() * static_cast<std::size_t>(y);
        add_row_noise(&this->density_[static_cast<std::size_t>(replica)][begin], noise.at(y), s,
                      lattice.nx, &z[begin]);
    }
    return this->field_of(z);
}

template class ExplicitIntegrator<float>;
template class ExplicitIntegrator<double>;

}  // namespace grainfield::simulate
