#include "simulate/field/integrators/paper_integrator.h"

#include "simulate/field/kernels/row_noise_window.h"

namespace grainfield::simulate {

namespace {

template <class Real>
LineSweep<Real> sweep_of(const FieldSetup& setup, double strength) {
    const double dx2 = setup.lattice.spacing * setup.lattice.spacing;
    return {setup.lattice, setup.dt * setup.model.d0 / (2 * dx2), setup.dt / (4 * dx2),
            strength / 2, setup.lattice.dimension == 1 ? AfterSolve::reflect : AfterSolve::keep};
}

}  // namespace

template <class Real>
PaperIntegrator<Real>::PaperIntegrator(const FieldSetup& setup, int threads)
    : FieldEngine<Real>(setup, OrderScheme::crank_nicolson, threads),
      kick_(setup.lattice.padded_cells()),
      next_(setup.lattice.padded_cells()),
      sweep_(sweep_of<Real>(setup, this->noise_strength())) {}

// w/2 of the rows [first, last).
template <class Real>
void PaperIntegrator<Real>::kick_rows(int replica, int first, int last) {
    const Lattice& lattice = this->lattice();
    const RowNoiseWindow::Fill fill = [&](std::uint32_t line, std::span<float> out) {
        this->fill_noise(replica, line, out);
    };
    RowNoiseWindow noise(lattice.nx, lattice.ny, lattice.dimension, fill);
    thread_local AlignedVector<Real> zero;
    zero.assign(lattice.stride(), Real{0});
    const auto s = static_cast<Real>(this->noise_strength() / 2);
    for (int y = first; y < last; ++y) {
        add_row_noise(zero.data(), noise.at(y), s, lattice.nx,
                      &kick_[lattice.stride() * static_cast<std::size_t>(y)]);
    }
}

// next = ρ + w/2 + explicit diffusion.
template <class Real>
void PaperIntegrator<Real>::explicit_rows(const Array& rho, int first, int last, Real h_x,
                                          Real h_y) {
    const Lattice& lattice = this->lattice();
    const int ny = lattice.ny;
    const auto row = [&](const Array& array, int y) {
        return &array[lattice.stride() * static_cast<std::size_t>((y + ny) % ny)];
    };
    for (int y = first; y < last; ++y) {
        Real* out = &next_[lattice.stride() * static_cast<std::size_t>(y)];
        const Real* kick = row(kick_, y);
        const Real* from = row(rho, y);
        for (int x = 0; x < lattice.nx; ++x) out[x] = from[x] + kick[x];
        add_row_diffusion(
            out, RowStencil<Real>{row(rho, y - 1), from, row(rho, y + 1)},
            RowStencil<Real>{row(this->diffusivity_, y - 1), row(this->diffusivity_, y),
                             row(this->diffusivity_, y + 1)},
            h_x, h_y, lattice.nx, out);
    }
}

template <class Real>
void PaperIntegrator<Real>::step(Team& team) {
    const Lattice& lattice = this->lattice();
    const auto h = static_cast<Real>(this->setup_.dt / (4 * lattice.spacing * lattice.spacing));
    const typename LineSweep<Real>::Noise none;
    const auto split = [&team](int count, auto body) {
        team.split(count, [&body](std::int64_t first, std::int64_t last) {
            body(static_cast<int>(first), static_cast<int>(last));
        });
    };
    if (lattice.dimension == 1) {
        sweep_.ring(this->diffusivity_, this->density_,
                    [this](int replica, std::uint32_t line, std::span<float> out) {
                        this->fill_noise(replica, line, out);
                    });
    } else {
        for (int replica = 0; replica < this->setup_.replicas; ++replica) {
            Array& rho = this->density_[static_cast<std::size_t>(replica)];
            const std::span<Array> one(&rho, 1);
            split(lattice.ny, [&](int first, int last) { kick_rows(replica, first, last); });
            split(lattice.ny, [&](int first, int last) { explicit_rows(rho, first, last, 0, h); });
            rho.swap(next_);
            split(sweep_.bundles(lattice.ny), [&](int first, int last) {
                for (int b = first; b < last; ++b) sweep_.rows(b, this->diffusivity_, one, none);
            });
            split(lattice.ny, [&](int first, int last) { explicit_rows(rho, first, last, h, 0); });
            rho.swap(next_);
            split(sweep_.bundles(lattice.nx), [&](int first, int last) {
                for (int b = first; b < last; ++b) sweep_.columns(b, this->diffusivity_, one, none);
            });
        }
    }
    if (!this->setup_.has_order) return;
    this->advance_order(team);
    this->refresh_diffusivity(team);
}

template class PaperIntegrator<float>;
template class PaperIntegrator<double>;

}  // namespace grainfield::simulate
