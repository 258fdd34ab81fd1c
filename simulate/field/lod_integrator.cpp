#include "simulate/field/lod_integrator.h"

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
      mean_(this->diffusivity_),
      sweep_(sweep_of<Real>(setup, this->noise_strength())) {}

template <class Real>
std::vector<std::pair<std::string, typename LodIntegrator<Real>::Array*>>
LodIntegrator<Real>::more_state() {
    if (this->setup_.hold == 1) return {};
    return {{"mean diffusivity", &mean_}};
}

// D̄ of sixteen rows, and D_{n+1} in the place of D_n.
template <class Real>
void LodIntegrator<Real>::average_diffusivity(int first) {
    const std::size_t stride = this->lattice().stride();
    const int rows = std::min(OrderField<Real>::rows_at_once, this->lattice().ny - first);
    thread_local AlignedVector<Real> next;
    next.resize(stride * OrderField<Real>::rows_at_once);
    this->read_diffusivity(first, next.data());
    Real* now = &this->diffusivity_[stride * static_cast<std::size_t>(first)];
    Real* mean = &mean_[stride * static_cast<std::size_t>(first)];
    const std::size_t count = stride * static_cast<std::size_t>(rows);
    for (std::size_t i = 0; i < count; ++i) {
        mean[i] = Real{0.5} * (now[i] + next[i]);
        now[i] = next[i];
    }
}

template <class Real>
void LodIntegrator<Real>::step() {
    const Lattice& lattice = this->lattice();
    const bool new_order = this->setup_.has_order && this->step_ % this->setup_.hold == 0;
    const bool x_first = this->step_ % 2 == 0;
    const typename LineSweep<Real>::Noise noise = [this](int replica, std::uint32_t line,
                                                         std::span<float> out) {
        this->fill_noise(replica, line, out);
    };
    if (new_order) {
        const auto serial = static_cast<std::uint64_t>(this->step_ / this->setup_.hold);
        this->order_.advance(serial + 1, this->team_);
    }
    if (lattice.dimension == 1) {
        if (new_order) average_diffusivity(0);
        sweep_.ring(mean_, this->density_, noise);
        return;
    }
    // A bundle of rows is averaged and, where x comes first, swept while it is in the cache.
    if (new_order || x_first) {
        this->team_.split(this->row_blocks(), [&](std::int64_t first, std::int64_t last) {
            for (auto block = static_cast<int>(first); block < last; ++block) {
                if (new_order) average_diffusivity(block * OrderField<Real>::rows_at_once);
                if (x_first) sweep_.rows(block, mean_, this->density_, noise);
            }
        });
    }
    this->team_.split(sweep_.bundles(lattice.nx), [&](std::int64_t first, std::int64_t last) {
        for (auto block = static_cast<int>(first); block < last; ++block) {
            sweep_.columns(block, mean_, this->density_, noise);
        }
    });
    if (x_first) return;
    this->team_.split(sweep_.bundles(lattice.ny), [&](std::int64_t first, std::int64_t last) {
        for (auto block = static_cast<int>(first); block < last; ++block) {
            sweep_.rows(block, mean_, this->density_, noise);
        }
    });
}

template class LodIntegrator<float>;
template class LodIntegrator<double>;

}  // namespace grainfield::simulate
