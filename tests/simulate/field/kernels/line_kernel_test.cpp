#include "simulate/field/kernels/line_kernel.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "simulate/field/kernels/line_sweep.h"

namespace grainfield::simulate {
namespace {

// Gauss elimination with pivoting of the whole ring: the plain reference.
std::vector<double> solve_ring(const std::vector<double>& d, double h, std::vector<double> r) {
    const std::size_t n = d.size();
    std::vector<std::vector<double>> m(n, std::vector<double>(n, 0));
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t right = (i + 1) % n;
        const double a = h * (d[i] + d[right]);
        m[i][i] += 1 + a;
        m[i][right] -= a;
        m[right][right] += a;
        m[right][i] -= a;
    }
    for (std::size_t c = 0; c < n; ++c) {
        std::size_t pivot = c;
        for (std::size_t i = c; i < n; ++i) {
            if (std::abs(m[i][c]) > std::abs(m[pivot][c])) pivot = i;
        }
        std::swap(m[c], m[pivot]);
        std::swap(r[c], r[pivot]);
        for (std::size_t i = c + 1; i < n; ++i) {
            const double f = m[i][c] / m[c][c];
            for (std::size_t j = c; j < n; ++j) m[i][j] -= f * m[c][j];
            r[i] -= f * r[c];
        }
    }
    for (std::size_t c = n; c-- > 0;) {
        for (std::size_t j = c + 1; j < n; ++j) r[c] -= m[c][j] * r[j];
        r[c] /= m[c][c];
    }
    return r;
}

struct Problem {
    Lattice lattice;
    std::vector<double> d, rho;
    std::vector<float> noise;  // per lane bundle: [cell][lane]
};

Problem random_problem(int nx, int ny, std::uint64_t seed) {
    Problem p{{ny == 1 ? 1 : 2, nx, ny, 1}, {}, {}, {}};
    RandomStream random(seed, "line test");
    const std::size_t cells = p.lattice.cells();
    for (std::size_t i = 0; i < cells; ++i) {
        // A third of the cells hardly conduct: the hard case of strong order.
        p.d.push_back(random.uniform() < 0.33 ? 1e-12 : random.uniform());
        p.rho.push_back(random.normal());
    }
    return p;
}

template <class Real>
AlignedVector<Real> padded(const Lattice& lattice, const std::vector<double>& values) {
    AlignedVector<Real> out(lattice.padded_cells(), Real{0});
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto nx = static_cast<std::size_t>(lattice.nx);
        out[i / nx * lattice.stride() + i % nx] = static_cast<Real>(values[i]);
    }
    return out;
}

template <class Real>
void compare_with_plain_solution(int nx, int ny, double a_max, bool along_x) {
    const Problem p = random_problem(nx, ny, static_cast<std::uint64_t>(nx * 100 + ny));
    const double h = a_max / 2;
    const LineSweep<Real> sweep(p.lattice, a_max, h, 0, AfterSolve::reflect);
    AlignedVector<Real> d = padded<Real>(p.lattice, p.d);
    std::vector<AlignedVector<Real>> rho{padded<Real>(p.lattice, p.rho)};
    const typename LineSweep<Real>::Noise none;
    if (ny == 1) {
        sweep.ring(d, rho, none);
    } else {
        const int lines = along_x ? ny : nx;
        for (int b = 0; b < sweep.bundles(lines); ++b) {
            if (along_x) sweep.rows(b, d, rho, none);
            if (!along_x) sweep.columns(b, d, rho, none);
        }
    }
    // Rounding times the condition number, 1 + 4a.
    const double tolerance =
        static_cast<double>(std::numeric_limits<Real>::epsilon()) * (20 + 4 * a_max);
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(nx) +
               static_cast<std::size_t>(x);
    };
    const int lines = along_x ? ny : nx;
    const int cells = along_x ? nx : ny;
    for (int line = 0; line < lines; ++line) {
        std::vector<double> one_d, one_rho;
        for (int i = 0; i < cells; ++i) {
            one_d.push_back(p.d[along_x ? at(i, line) : at(line, i)]);
            one_rho.push_back(p.rho[along_x ? at(i, line) : at(line, i)]);
        }
        const std::vector<double> q = solve_ring(one_d, h, one_rho);
        for (int i = 0; i < cells; ++i) {
            const int x = along_x ? i : line;
            const int y = along_x ? line : i;
            const auto got =
                static_cast<double>(rho[0][static_cast<std::size_t>(y) * p.lattice.stride() +
                                           static_cast<std::size_t>(x)]);
            const auto index = static_cast<std::size_t>(i);
            EXPECT_NEAR(got, 2 * q[index] - one_rho[index], tolerance)
                << nx << " x " << ny << ", a = " << a_max << ", cell " << x << ", " << y;
        }
    }
}

TEST(LineKernel, SolvesEveryRingLikeAPlainElimination) {
    for (const auto& [nx, ny] :
         {std::pair{1, 2}, {2, 2}, {3, 5}, {4, 4}, {17, 19}, {37, 16}, {16, 37}}) {
        for (const double a : {1e-9, 0.05, 0.6, 12.0, 1200.0}) {
            for (const bool along_x : {true, false}) {
                compare_with_plain_solution<double>(nx, ny, a, along_x);
                compare_with_plain_solution<float>(nx, ny, a, along_x);
            }
        }
    }
}

TEST(LineKernel, SolvesTheRingOfALine) {
    for (const int nx : {1, 2, 3, 5, 16, 17, 64, 101}) {
        for (const double a : {0.05, 4.0, 300.0}) {
            compare_with_plain_solution<double>(nx, 1, a, true);
            compare_with_plain_solution<float>(nx, 1, a, true);
        }
    }
}

TEST(LineKernel, WhereNothingConductsNothingMoves) {
    const Lattice lattice{2, 20, 20, 1};
    const LineSweep<float> sweep(lattice, 0.5, 0.25, 0, AfterSolve::reflect);
    const AlignedVector<float> d(lattice.padded_cells(), 0.0F);
    std::vector<AlignedVector<float>> rho{AlignedVector<float>(lattice.padded_cells(), 3.25F)};
    const auto before = rho[0];
    for (int b = 0; b < 2; ++b) sweep.rows(b, d, rho, {});
    EXPECT_EQ(rho[0], before);
}

TEST(LineKernel, TransposesGoThereAndBack) {
    for (const int rows : {1, 2, 4, 7, 16}) {
        for (const int columns : {1, 3, 4, 18, 33}) {
            const Lattice lattice{2, columns, rows, 1};
            AlignedVector<double> in(lattice.stride() * 16, -1);
            for (int y = 0; y < rows; ++y) {
                for (int x = 0; x < columns; ++x) {
                    in[static_cast<std::size_t>(y) * lattice.stride() +
                       static_cast<std::size_t>(x)] = 100 * y + x;
                }
            }
            AlignedVector<double> lanes(lattice.stride() * line_lanes, -5);
            AlignedVector<double> out(in.size(), -1);
            lanes_from_rows(in.data(), lattice.stride(), rows, columns, lanes.data());
            for (int x = 0; x < columns; ++x) {
                for (int y = 0; y < line_lanes; ++y) {
                    EXPECT_EQ(lanes[static_cast<std::size_t>(x * line_lanes + y)],
                              y < rows ? 100 * y + x : 0);
                }
            }
            rows_from_lanes(lanes.data(), rows, columns, out.data(), lattice.stride());
            EXPECT_EQ(in, out);
        }
    }
}

TEST(LineKernel, TheWarmUpGrowsWithTheStepAndTheDigits) {
    EXPECT_EQ(warm_up(0, 1e-16), 1);
    EXPECT_LT(warm_up(0.6, 1e-8), warm_up(0.6, 1e-16));
    EXPECT_LT(warm_up(0.6, 1e-8), warm_up(10, 1e-8));
    // Influence of a cell of the infinite constant ring: ((√κ − 1)/(√κ + 1))^n.
    const int n = warm_up(2, 1e-10);
    EXPECT_LE(std::pow(0.5, n), 1e-10);
    EXPECT_GT(std::pow(0.5, n - 2), 1e-10);
}

}  // namespace
}  // namespace grainfield::simulate
