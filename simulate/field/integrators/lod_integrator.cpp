#include "simulate/field/integrators/lod_integrator.h"

#include <algorithm>

namespace grainfield::simulate {

namespace {

template <class Real>
LineSweep<Real> sweep_of(const FieldSetup& setup, double strength) {
    const double dx2 = setup.lattice.spacing * setup.lattice.spacing;
    return {setup.lattice, setup.dt * setup.model.d0 / (2 * dx2), setup.dt / (4 * dx2),
            strength / 2, AfterSolve::reflect};
}

}  // namespace

template <class Real>
LodIntegrator<Real>::LodIntegrator(const FieldSetup& setup, int threads)
    : FieldEngine<Real>(setup, OrderScheme::exact, threads),
      sweep_(sweep_of<Real>(setup, this->noise_strength())) {}

template <class Real>
void LodIntegrator<Real>::step(Team& team) {
    const Lattice& lattice = this->lattice();
    const bool new_order = this->order_is_due();
    const bool x_first = this->step_ % 2 == 0;
    const typename LineSweep<Real>::Noise noise = [this](int replica, std::uint32_t line,
                                                         std::span<float> out) {
        this->fill_noise(replica, line, out);
    };
    if (new_order) this->advance_order(team);
    if (lattice.dimension == 1) {
        if (new_order) this->average_diffusivity(0);
        sweep_.ring(this->mean_, this->density_, noise);
        return;
    }
    // A bundle of rows is averaged and, where x comes first, swept while it is in the cache.
    if (new_order || x_first) {
        team.split(this->row_blocks(), [&](std::int64_t first, std::int64_t last) {
            for (auto block = static_cast<int>(first); block < last; ++block) {
                if (new_order) this->average_diffusivity(block * OrderField<Real>::rows_at_once);
                if (x_first) sweep_.rows(block, this->mean_, this->density_, noise);
            }
        });
    }
    team.split(sweep_.bundles(lattice.nx), [&](std::int64_t first, std::int64_t last) {
        for (auto block = static_cast<int>(first); block < last; ++block) {
            sweep_.columns(block, this->mean_, this->density_, noise);
        }
    });
    if (x_first) return;
    team.split(sweep_.bundles(lattice.ny), [&](std::int64_t first, std::int64_t last) {
        for (auto block = static_cast<int>(first); block < last; ++block) {
            sweep_.rows(block, this->mean_, this->density_, noise);
        }
    });
}

template class LodIntegrator<float>;
template class LodIntegrator<double>;

}  // namespace grainfield::simulate
