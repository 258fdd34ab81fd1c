#include "simulate/field/kernels/line_sweep.h"

#include <algorithm>
#include <limits>

namespace grainfield::simulate {

namespace {

// Lines along x and along y draw from different noise lines.
constexpr std::uint32_t columns_line = 0x40000000U;

std::size_t padded(int n) {
    return static_cast<std::size_t>((n + line_lanes - 1) / line_lanes) * line_lanes;
}

// out[j] = ring[(j − before) mod cells] for j < count.
template <class T>
void unroll(const T* ring, int cells, int before, std::size_t count, AlignedVector<T>& out) {
    out.resize(count);
    auto at = static_cast<std::size_t>((cells - before % cells) % cells);
    for (std::size_t j = 0; j < count; at = 0) {
        const std::size_t some = std::min(count - j, static_cast<std::size_t>(cells) - at);
        std::copy_n(ring + at, some, &out[j]);
        j += some;
    }
}

}  // namespace

template <class Real>
struct LineSweep<Real>::Buffers {
    Array upper, lower, inverse, scratch, diffusivity, field, before, unrolled;
    AlignedVector<float> noise, face_noise, unrolled_noise;

    LineFactors<Real> factors(std::size_t length) {
        for (Array* array : {&upper, &lower, &inverse, &scratch}) {
            if (array->size() < length * line_lanes) array->resize(length * line_lanes);
        }
        return {upper.data(), lower.data(), inverse.data()};
    }
};

template <class Real>
typename LineSweep<Real>::Buffers& LineSweep<Real>::buffers() {
    thread_local Buffers buffers;
    return buffers;
}

template <class Real>
LineSweep<Real>::LineSweep(const Lattice& lattice, double a_max, double h, double s,
                           AfterSolve after)
    : lattice_(lattice),
      h_(static_cast<Real>(h)),
      s_(static_cast<Real>(s)),
      after_(after),
      warm_(warm_up(a_max, 0.5 * static_cast<double>(std::numeric_limits<Real>::epsilon()))) {}

template <class Real>
double LineSweep<Real>::solve(const LineBundle& lines, const LineFactors<Real>& factors,
                              Real* field, std::size_t stride, const float* noise,
                              bool squared) const {
    Buffers& b = buffers();
    if (!squared) {
        solve_lines(lines, factors, field, stride, noise, s_, b.scratch.data(), after_);
        return 0;
    }
    const auto cells = static_cast<std::size_t>(lines.cells);
    b.before.resize(cells * line_lanes);
    for (std::size_t i = 0; i < cells; ++i) {
        std::copy_n(field + i * stride, line_lanes, &b.before[i * line_lanes]);
    }
    solve_lines(lines, factors, field, stride, noise, s_, b.scratch.data(), AfterSolve::keep);
    const double sum = squared_differences(lines, field, stride);
    for (std::size_t i = 0; i < cells; ++i) {
        for (std::size_t l = 0; l < line_lanes; ++l) {
            Real& value = field[i * stride + l];
            value = (value + value) - b.before[i * line_lanes + l];
        }
    }
    return sum;
}

template <class Real>
void LineSweep<Real>::rows(int bundle, const Array& diffusivity, std::span<Array> fields,
                           const Noise& noise, std::span<double> squares) const {
    Buffers& b = buffers();
    const LineBundle lines{lattice_.nx, warm_};
    const LineFactors<Real> factors = b.factors(lines.length());
    const std::size_t count = static_cast<std::size_t>(lattice_.nx) * line_lanes;
    const std::size_t room = padded(lattice_.nx) * line_lanes;
    b.diffusivity.resize(room);
    b.field.resize(room);
    const int first = bundle * line_lanes;
    const int rows = std::min(line_lanes, lattice_.ny - first);
    const std::size_t begin = static_cast<std::size_t>(first) * lattice_.stride();
    lanes_from_rows(&diffusivity[begin], lattice_.stride(), rows, lattice_.nx,
                    b.diffusivity.data());
    factor_lines(lines, b.diffusivity.data(), std::size_t{line_lanes}, h_, factors);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        Real* field = &fields[f][begin];
        lanes_from_rows(field, lattice_.stride(), rows, lattice_.nx, b.field.data());
        if (noise) {
            b.noise.resize(count);
            noise(static_cast<int>(f), static_cast<std::uint32_t>(bundle), b.noise);
        }
        const double sum = solve(lines, factors, b.field.data(), std::size_t{line_lanes},
                                 noise ? b.noise.data() : nullptr, !squares.empty());
        if (!squares.empty()) squares[f] += sum;
        rows_from_lanes(b.field.data(), rows, lattice_.nx, field, lattice_.stride());
    }
}

template <class Real>
void LineSweep<Real>::columns(int bundle, const Array& diffusivity, std::span<Array> fields,
                              const Noise& noise, std::span<double> squares) const {
    Buffers& b = buffers();
    const LineBundle lines{lattice_.ny, warm_};
    const LineFactors<Real> factors = b.factors(lines.length());
    const auto first = static_cast<std::size_t>(bundle) * line_lanes;
    factor_lines(lines, &diffusivity[first], lattice_.stride(), h_, factors);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        if (noise) {
            b.noise.resize(static_cast<std::size_t>(lattice_.ny) * line_lanes);
            noise(static_cast<int>(f), columns_line + static_cast<std::uint32_t>(bundle), b.noise);
        }
        const double sum = solve(lines, factors, &fields[f][first], lattice_.stride(),
                                 noise ? b.noise.data() : nullptr, !squares.empty());
        if (!squares.empty()) squares[f] += sum;
    }
}

template <class Real>
void LineSweep<Real>::ring(const Array& diffusivity, std::span<Array> fields, const Noise& noise,
                           std::span<double> squares) const {
    Buffers& b = buffers();
    const int cells = lattice_.nx;
    const int part = (cells + line_lanes - 1) / line_lanes;
    const std::size_t all_parts = padded(cells);
    const LineBundle lines{part + 2 * warm_, 0};
    const LineFactors<Real> factors = b.factors(lines.length());
    const std::size_t room = padded(lines.cells) * line_lanes;
    b.diffusivity.resize(room);
    b.field.resize(room);
    // Lane l holds the cells from l · part − warm on. Transposes round lanes up to fours: the room
    // behind the last one.
    const auto cut = [&](const auto& ring, auto& unrolled, auto& lanes) {
        unroll(ring.data(), cells, warm_,
               all_parts + 2 * static_cast<std::size_t>(warm_) + line_lanes, unrolled);
        lanes_from_rows(unrolled.data(), static_cast<std::size_t>(part), line_lanes, lines.cells,
                        lanes.data());
    };
    cut(diffusivity, b.unrolled, b.diffusivity);
    factor_lines(lines, b.diffusivity.data(), std::size_t{line_lanes}, h_, factors);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        cut(fields[f], b.unrolled, b.field);
        if (noise) {
            b.face_noise.resize(static_cast<std::size_t>(cells));
            b.noise.resize(room);
            noise(static_cast<int>(f), 0, b.face_noise);
            cut(b.face_noise, b.unrolled_noise, b.noise);
        }
        solve_lines(lines, factors, b.field.data(), std::size_t{line_lanes},
                    noise ? b.noise.data() : nullptr, s_, b.scratch.data(), after_);
        b.unrolled.resize(all_parts);
        rows_from_lanes(&b.field[static_cast<std::size_t>(warm_) * line_lanes], line_lanes, part,
                        b.unrolled.data(), static_cast<std::size_t>(part));
        Real* field = fields[f].data();
        const Real* solved = b.unrolled.data();
        for (int x = 0; x < cells && !squares.empty(); ++x) {
            const int next = x + 1 == cells ? 0 : x + 1;
            const double step = 0.5 * (static_cast<double>(solved[next] + field[next]) -
                                       static_cast<double>(solved[x] + field[x]));
            squares[f] += step * step;
        }
        std::copy_n(solved, cells, field);
    }
}

template class LineSweep<float>;
template class LineSweep<double>;

}  // namespace grainfield::simulate
