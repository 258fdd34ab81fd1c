#include "simulate/field/model/order_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace grainfield::simulate {

namespace {

std::size_t padded(int n, int to) {
    return static_cast<std::size_t>((n + to - 1) / to) * static_cast<std::size_t>(to);
}

// Odd multiples of a cache line keep columns out of each other's cache sets.
std::size_t column_distance(int n) {
    const std::size_t length = padded(n, 16);
    return length % 32 == 0 ? length + 16 : length;
}

}  // namespace

template <class Real>
OrderField<Real>::Scratch::Scratch(const Lattice& lattice)
    : nx(lattice.nx),
      distance(column_distance(nx)),
      packed(rows_at_once / 2 * distance),
      line(distance) {}

template <class Real>
OrderField<Real>::OrderField(const Lattice& lattice, OrderSpectrum spectrum, std::uint64_t seed)
    : lattice_(lattice),
      spectrum_(std::move(spectrum)),
      noise_(seed, "order noise"),
      distance_(lattice.ny == 1 ? 1 : column_distance(lattice.ny)),
      along_y_(lattice.ny),
      along_x_(lattice.nx),
      modes_(distance_ * static_cast<std::size_t>(spectrum_.columns())),
      transformed_(modes_.size()),
      loss_(2 * modes_.size()),
      amplitude_(2 * modes_.size()) {
    fill_coefficients();
}

// Modes ky < 0 of a column, which stand at its end.
template <class Real>
std::size_t OrderField<Real>::negative_rows(int kx) const {
    const int rows = spectrum_.rows(kx);
    return static_cast<std::size_t>(std::min(rows, lattice_.ny - 1 - rows));
}

template <class Real>
void OrderField<Real>::fill_coefficients() {
    const int ny = lattice_.ny;
    for (int kx = 0; kx < spectrum_.columns(); ++kx) {
        const std::size_t begin = 2 * distance_ * static_cast<std::size_t>(kx);
        for (int y = 0; y <= spectrum_.rows(kx); ++y) {
            // Self-conjugate modes are real and have all of the variance.
            const bool is_real = is_symmetric(kx) && (y == 0 || 2 * y == ny);
            const double amplitude = spectrum_.amplitude(kx)[y];
            for (const int at : {y, (ny - y) % ny}) {
                const std::size_t j = begin + 2 * static_cast<std::size_t>(at);
                loss_[j] = loss_[j + 1] = static_cast<Real>(spectrum_.loss(kx)[y]);
                amplitude_[j] =
                    static_cast<Real>(is_real ? amplitude : amplitude / std::numbers::sqrt2);
                amplitude_[j + 1] = is_real ? Real{0} : amplitude_[j];
            }
        }
    }
}

template <class Real>
void OrderField<Real>::mirror(int kx) {
    std::complex<Real>* c = &modes_[distance_ * static_cast<std::size_t>(kx)];
    const int ny = lattice_.ny;
    for (int y = 1; 2 * y < ny && y <= spectrum_.rows(kx); ++y) c[ny - y] = std::conj(c[y]);
}

// Modes ky ≥ 0 and ky < 0 draw from lines of their own, counted from ky = 0: a mode has the same
// noise whatever else is kept.
template <class Real>
void OrderField<Real>::update_column(int kx, std::uint64_t step) {
    constexpr std::uint32_t negative_line = 0x80000000U;
    thread_local AlignedVector<float> zeta;
    const std::size_t begin = distance_ * static_cast<std::size_t>(kx);
    // A complex number is an array of two.
    Real* c = reinterpret_cast<Real*>(&modes_[begin]);
    const Real* loss = &loss_[2 * begin];
    const Real* amplitude = &amplitude_[2 * begin];
    zeta.resize(2 * static_cast<std::size_t>(spectrum_.rows(kx) + 1));
    noise_.normal(step, static_cast<std::uint32_t>(kx), zeta);
    for (std::size_t j = 0; j < zeta.size(); ++j) {
        c[j] += amplitude[j] * static_cast<Real>(zeta[j]) - loss[j] * c[j];
    }
    if (is_symmetric(kx)) {
        mirror(kx);
        return;
    }
    zeta.resize(2 * negative_rows(kx));
    noise_.normal(step, negative_line + static_cast<std::uint32_t>(kx), zeta);
    std::size_t j = 2 * static_cast<std::size_t>(lattice_.ny);
    for (std::size_t i = 0; i < zeta.size(); i += 2) {
        j -= 2;
        c[j] += amplitude[j] * static_cast<Real>(zeta[i]) - loss[j] * c[j];
        c[j + 1] += amplitude[j + 1] * static_cast<Real>(zeta[i + 1]) - loss[j + 1] * c[j + 1];
    }
}

template <class Real>
void OrderField<Real>::update_row(std::uint64_t step) {
    thread_local AlignedVector<float> zeta;
    zeta.resize(2 * static_cast<std::size_t>(spectrum_.columns()));
    noise_.normal(step, 0, zeta);
    Real* c = reinterpret_cast<Real*>(modes_.data());
    for (std::size_t j = 0; j < zeta.size(); ++j) {
        c[j] += amplitude_[j] * static_cast<Real>(zeta[j]) - loss_[j] * c[j];
    }
}

template <class Real>
void OrderField<Real>::draw_stationary() {
    std::ranges::fill(modes_, std::complex<Real>{});
    const AlignedVector<Real> kept = amplitude_;
    for (int kx = 0; kx < spectrum_.columns(); ++kx) {
        const std::size_t begin = 2 * distance_ * static_cast<std::size_t>(kx);
        for (int y = 0; y <= spectrum_.rows(kx); ++y) {
            const double amplitude = spectrum_.amplitude(kx)[y];
            const double ratio = amplitude > 0 ? spectrum_.stationary(kx)[y] / amplitude : 0;
            for (const int at : {y, (lattice_.ny - y) % lattice_.ny}) {
                for (std::size_t part : {0U, 1U}) {
                    const std::size_t j = begin + 2 * static_cast<std::size_t>(at) + part;
                    amplitude_[j] = static_cast<Real>(ratio * static_cast<double>(kept[j]));
                }
            }
        }
        if (!is_one_row()) update_column(kx, 0);
    }
    if (is_one_row()) update_row(0);
    amplitude_ = kept;
}

template <class Real>
void OrderField<Real>::transform_column(int kx) {
    const std::size_t begin = distance_ * static_cast<std::size_t>(kx);
    along_y_.backward(&modes_[begin], &transformed_[begin]);
}

template <class Real>
void OrderField<Real>::advance(std::uint64_t step, Team& team) {
    if (is_one_row()) {
        update_row(step);
        return;
    }
    team.split(spectrum_.columns(), [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t kx = first; kx < last; ++kx) {
            update_column(static_cast<int>(kx), step);
            transform_column(static_cast<int>(kx));
        }
    });
}

template <class Real>
void OrderField<Real>::transform_columns(Team& team) {
    if (is_one_row()) return;
    team.split(spectrum_.columns(), [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t kx = first; kx < last; ++kx) transform_column(static_cast<int>(kx));
    });
}

template <class Real>
void OrderField<Real>::read_one_row(Scratch& scratch, Real* out) const {
    const int nx = lattice_.nx;
    std::complex<Real>* line = scratch.packed.data();
    std::fill_n(line, nx, std::complex<Real>{});
    for (int kx = 0; kx < spectrum_.columns(); ++kx) {
        const std::complex<Real> mode = modes_[static_cast<std::size_t>(kx)];
        line[kx] = mode;
        if (!is_symmetric(kx)) line[nx - kx] = std::conj(mode);
    }
    along_x_.backward(line, scratch.line.data());
    for (int x = 0; x < nx; ++x) out[x] = scratch.line[static_cast<std::size_t>(x)].real();
}

template <class Real>
void OrderField<Real>::read_rows(int first, Scratch& scratch, Real* out) const {
    if (is_one_row()) {
        read_one_row(scratch, out);
        return;
    }
    const int nx = lattice_.nx;
    const int rows = std::min(rows_at_once, lattice_.ny - first);
    const int pairs = (rows + 1) / 2;
    const int columns = spectrum_.columns();
    std::complex<Real>* packed = scratch.packed.data();
    const std::size_t distance = scratch.distance;
    for (int p = 0; p < pairs; ++p) {
        std::complex<Real>* line = packed + distance * static_cast<std::size_t>(p);
        std::fill(line + columns, line + nx, std::complex<Real>{});
    }
    for (int kx = 0; kx < columns; ++kx) {
        // Padding keeps the partner of a last odd row at zero or unused.
        const std::complex<Real>* in = &transformed_[distance_ * static_cast<std::size_t>(kx) +
                                                     static_cast<std::size_t>(first)];
        std::complex<Real>* low = packed + kx;
        std::complex<Real>* high = packed + (nx - kx);
        if (is_symmetric(kx)) {
            for (int p = 0; p < pairs; ++p, low += distance) {
                *low = {in[2 * p].real(), in[2 * p + 1].real()};
            }
            continue;
        }
        for (int p = 0; p < pairs; ++p, low += distance, high += distance) {
            const std::complex<Real> a = in[2 * p];
            const std::complex<Real> b = in[2 * p + 1];
            *low = {a.real() - b.imag(), a.imag() + b.real()};
            *high = {a.real() + b.imag(), b.real() - a.imag()};
        }
    }
    const std::size_t stride = lattice_.stride();
    for (int p = 0; p < pairs; ++p) {
        along_x_.backward(packed + distance * static_cast<std::size_t>(p), scratch.line.data());
        Real* even = out + stride * 2 * static_cast<std::size_t>(p);
        for (int x = 0; x < nx; ++x) even[x] = scratch.line[static_cast<std::size_t>(x)].real();
        if (2 * p + 1 == rows) break;
        Real* odd = even + stride;
        for (int x = 0; x < nx; ++x) odd[x] = scratch.line[static_cast<std::size_t>(x)].imag();
    }
}

template <class Real>
std::vector<double> OrderField<Real>::modes() const {
    std::vector<double> list;
    for (int kx = 0; kx < spectrum_.columns(); ++kx) {
        const std::complex<Real>* c = &modes_[distance_ * static_cast<std::size_t>(kx)];
        const auto put = [&](std::complex<Real> z) {
            list.push_back(static_cast<double>(z.real()));
            list.push_back(static_cast<double>(z.imag()));
        };
        for (int y = 0; y <= spectrum_.rows(kx); ++y) put(c[y]);
        for (std::size_t y = negative_rows(kx); y > 0; --y)
            put(c[static_cast<std::size_t>(lattice_.ny) - y]);
    }
    return list;
}

template <class Real>
void OrderField<Real>::set_modes(const std::vector<double>& modes) {
    const double* next = modes.data();
    const auto take = [&next] {
        const double re = *next++;
        const double im = *next++;
        return std::complex<Real>(static_cast<Real>(re), static_cast<Real>(im));
    };
    for (int kx = 0; kx < spectrum_.columns(); ++kx) {
        std::complex<Real>* c = &modes_[distance_ * static_cast<std::size_t>(kx)];
        for (int y = 0; y <= spectrum_.rows(kx); ++y) c[y] = take();
        for (std::size_t y = negative_rows(kx); y > 0; --y)
            c[static_cast<std::size_t>(lattice_.ny) - y] = take();
    }
}

template class OrderField<float>;
template class OrderField<double>;

}  // namespace grainfield::simulate
