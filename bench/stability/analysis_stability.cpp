// Errors of S(k), the mean squared displacement and the number variance where digits cancel, beside
// those of the formulas as one would write them down. Prints plot,series,x,y.
//   bench.stability.analysis [offset] [caged] [window]
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <fftw3.h>

#include "analysis/density/number_variance.h"
#include "analysis/density/synthetic_variance.h"
#include "analysis/motion/displacement.h"
#include "analysis/spectra/density_transform.h"
#include "bench/stability/rows.h"
#include "core/support/random.h"

using namespace grainfield;
using namespace grainfield::analysis;
using grainfield::bench::print_row;

namespace {

using Wide = long double;

std::vector<Vec2> uniform_points(double side, int count, std::uint64_t index) {
    RandomStream random(1, "stability points", index);
    std::vector<Vec2> points;
    for (int i = 0; i < count; ++i) {
        points.push_back({random.uniform(0, side), random.uniform(0, side)});
    }
    return points;
}

// ---- S(k) of points far from the origin ----

/// |ρ_k|²/N with coordinates, products and sums in `Real`.
template <class Real>
std::vector<double> plain_spectrum(const std::vector<Vec2>& points, Vec2 origin,
                                   const ModeGrid& grid) {
    std::vector<double> s;
    for (const Mode& mode : grid.modes()) {
        const Real kx = static_cast<Real>(mode.nx) * static_cast<Real>(grid.spacing().x);
        const Real ky = static_cast<Real>(mode.ny) * static_cast<Real>(grid.spacing().y);
        Real cosines = 0, sines = 0;
        for (const Vec2 p : points) {
            // The difference of two doubles of one size is exact.
            const Real phase =
                kx * static_cast<Real>(p.x - origin.x) + ky * static_cast<Real>(p.y - origin.y);
            cosines += std::cos(phase);
            sines += std::sin(phase);
        }
        const Real power = cosines * cosines + sines * sines;
        s.push_back(static_cast<double>(power) / static_cast<double>(points.size()));
    }
    return s;
}

/// RMS over the modes; ⟨S⟩ = 1.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

void spectrum_far_away() {
    constexpr double side = 100;
    const double step = 2 * std::numbers::pi / side;
    const ModeGrid grid({step, step}, 2);
    const std::vector<Vec2> near = uniform_points(side, 2000, 0);
    const std::vector<double> of_near = plain_spectrum<Wide>(near, {}, grid);
    const NonuniformFourier fourier(grid);
    for (int decade = 0; decade <= 9; ++decade) {
        const double x = std::pow(10.0, decade);
        const Vec2 origin{x, x};
        std::vector<Vec2> points = near;
        for (Vec2& p : points) p += origin;
        const std::vector<double> truth = plain_spectrum<Wide>(points, origin, grid);
        const auto error = [&](const std::vector<std::complex<double>>& modes) {
            std::vector<double> s;
            for (const std::complex<double> rho : modes) {
                s.push_back(std::norm(rho) / static_cast<double>(points.size()));
            }
            return difference(s, truth);
        };
        print_row("offset", "ours, direct sum", x, error(density_modes(points, origin, grid)));
        print_row("offset", "ours, non-uniform FFT", x,
                  error(fourier.modes(points, {}, origin, grid)));
        print_row("offset", "naive, double", x,
                  difference(plain_spectrum<double>(points, {}, grid), truth));
        print_row("offset", "naive, float", x,
                  difference(plain_spectrum<float>(points, {}, grid), truth));
        print_row("offset", "rounding of the coordinates", x, difference(of_near, truth));
    }
}

// ---- MSD of caged grains far from the origin ----

constexpr int kFrames = 2000;
constexpr double kCage = 0.01;  // RMS per axis [a]

/// An Ornstein–Uhlenbeck cage of 20 frames.
std::vector<std::vector<Vec2>> caged_tracks(double offset) {
    std::vector<std::vector<Vec2>> tracks;
    const double keep = std::exp(-1.0 / 20);
    for (std::uint64_t grain = 0; grain < 16; ++grain) {
        RandomStream random(1, "stability cage", grain);
        Vec2 r = kCage * Vec2{random.normal(), random.normal()};
        std::vector<Vec2> track;
        for (int t = 0; t < kFrames; ++t) {
            track.push_back(Vec2{offset, offset} + r);
            r = keep * r +
                kCage * std::sqrt(1 - keep * keep) * Vec2{random.normal(), random.normal()};
        }
        tracks.push_back(track);
    }
    return tracks;
}

/// Mean over start times of the squared difference of coordinates in `Real`, summed in long double.
template <class Real>
double plain_msd(const std::vector<std::vector<Vec2>>& tracks, std::size_t lag) {
    Wide sum = 0;
    for (const auto& track : tracks) {
        for (std::size_t t = 0; t + lag < track.size(); ++t) {
            const Real dx = static_cast<Real>(track[t + lag].x) - static_cast<Real>(track[t].x);
            const Real dy = static_cast<Real>(track[t + lag].y) - static_cast<Real>(track[t].y);
            sum += static_cast<Wide>(dx) * static_cast<Wide>(dx) +
                   static_cast<Wide>(dy) * static_cast<Wide>(dy);
        }
    }
    const auto pairs = static_cast<Wide>(tracks.size() * (tracks[0].size() - lag));
    return static_cast<double>(sum / pairs);
}

/// ⟨r²(t)⟩ − 2⟨r(t)·r(t + τ)⟩ + ⟨r²(t + τ)⟩ of every lag, the middle term by FFT of z = x + iy.
std::vector<double> fourier_msd(const std::vector<std::vector<Vec2>>& tracks) {
    const std::size_t n = tracks[0].size();
    std::vector<std::complex<double>> z(2 * n);
    auto* data = reinterpret_cast<fftw_complex*>(z.data());
    const int size = static_cast<int>(2 * n);
    const fftw_plan there = fftw_plan_dft_1d(size, data, data, FFTW_FORWARD, FFTW_ESTIMATE);
    const fftw_plan back = fftw_plan_dft_1d(size, data, data, FFTW_BACKWARD, FFTW_ESTIMATE);
    std::vector<double> msd(n, 0);
    for (const auto& track : tracks) {
        std::fill(z.begin(), z.end(), 0);
        for (std::size_t t = 0; t < n; ++t) z[t] = {track[t].x, track[t].y};
        fftw_execute(there);
        for (std::complex<double>& c : z) c = std::norm(c);
        fftw_execute(back);
        double squares = 0;
        for (const Vec2 r : track) squares += 2 * squared_norm(r);
        for (std::size_t lag = 0; lag < n; ++lag) {
            if (lag > 0) squares -= squared_norm(track[lag - 1]) + squared_norm(track[n - lag]);
            const double products = z[lag].real() / static_cast<double>(2 * n);
            msd[lag] += (squares - 2 * products) / static_cast<double>(n - lag) /
                        static_cast<double>(tracks.size());
        }
    }
    fftw_destroy_plan(there);
    fftw_destroy_plan(back);
    return msd;
}

void caged_grains() {
    for (int half = 0; half <= 14; ++half) {
        const double offset = std::pow(10.0, 0.5 * half);
        const auto tracks = caged_tracks(offset);
        Displacement ours({}, kFrames);
        for (int t = 0; t < kFrames; ++t) {
            Pattern pattern;
            pattern.frame = t;
            pattern.time = t;
            pattern.box = {{0, 0}, {2 * offset, 2 * offset}};
            for (std::size_t i = 0; i < tracks.size(); ++i) {
                pattern.position.push_back(tracks[i][static_cast<std::size_t>(t)]);
                pattern.id.push_back(static_cast<std::int64_t>(i));
            }
            ours.add(pattern);
        }
        const ObservableResult result = ours.result();
        const Curve& curve = *result.find_curve("msd");
        const std::vector<double> by_fourier = fourier_msd(tracks);
        double error_ours = 0, error_fourier = 0, error_float = 0;
        for (std::size_t i = 0; i < curve.find("t")->values.size(); ++i) {
            if (curve.text_columns.at("phase")[i] != "all") continue;
            const auto lag = static_cast<std::size_t>(std::lround(curve.find("t")->values[i]));
            const double truth = plain_msd<Wide>(tracks, lag);
            const auto worst = [&](double& error, double msd) {
                error = std::max(error, std::abs(msd / truth - 1));
            };
            worst(error_ours, curve.find("msd")->values[i]);
            worst(error_fourier, by_fourier[lag]);
            worst(error_float, plain_msd<float>(tracks, lag));
        }
        print_row("caged", "ours", offset, error_ours);
        print_row("caged", "naive, sums of squares by FFT, double", offset, error_fourier);
        print_row("caged", "naive, differences of float positions", offset, error_float);
    }
}

// ---- number variance of windows as large as the box ----

/// ⟨N²⟩ − ⟨N⟩² with sums in `Real`.
template <class Real>
double plain_variance(const std::vector<std::int64_t>& contents) {
    Real sum = 0, squares = 0;
    for (const std::int64_t n : contents) {
        sum += static_cast<Real>(n);
        squares += static_cast<Real>(n) * static_cast<Real>(n);
    }
    const auto count = static_cast<Real>(contents.size());
    const Real mean = sum / count;
    return static_cast<double>(squares / count - mean * mean);
}

double two_pass_variance(const std::vector<std::int64_t>& contents) {
    Wide mean = 0, sum = 0;
    for (const std::int64_t n : contents) mean += static_cast<Wide>(n);
    mean /= static_cast<Wide>(contents.size());
    for (const std::int64_t n : contents) {
        sum += (static_cast<Wide>(n) - mean) * (static_cast<Wide>(n) - mean);
    }
    return static_cast<double>(sum / static_cast<Wide>(contents.size()));
}

/// What every window of m × m cells of a periodic grid holds.
void add_contents(const std::vector<int>& cells, int n, int m,
                  std::vector<std::int64_t>& contents) {
    const auto index = [n](int x, int y) { return static_cast<std::size_t>(y % n * n + x % n); };
    std::vector<std::int64_t> rows(cells.size());  // of m cells along x
    for (int y = 0; y < n; ++y) {
        std::int64_t sum = 0;
        for (int x = 0; x < m; ++x) sum += cells[index(x, y)];
        for (int x = 0; x < n; ++x) {
            rows[index(x, y)] = sum;
            sum += cells[index(x + m, y)] - cells[index(x, y)];
        }
    }
    for (int x = 0; x < n; ++x) {
        std::int64_t sum = 0;
        for (int y = 0; y < m; ++y) sum += rows[index(x, y)];
        for (int y = 0; y < n; ++y) {
            contents.push_back(sum);
            sum += rows[index(x, y + m)] - rows[index(x, y)];
        }
    }
}

void windows_as_large_as_the_box() {
    constexpr double side = 100, step = 0.25;
    constexpr int cells_a_side = 400, particles = 9875, frames = 8;
    const Box box{{0, 0}, {side, side}, {Boundary::periodic, Boundary::periodic}};
    for (const int left : {1, 2, 4, 8, 16, 32, 64, 128, 256, 384}) {  // cells less than the box
        const int m = cells_a_side - left;
        const double window = m * step;
        NumberVarianceOptions options;
        options.smallest = options.largest = window;
        NumberVariance ours(options, box, frames);
        std::vector<std::int64_t> contents;
        for (int frame = 0; frame < frames; ++frame) {
            Pattern pattern;
            pattern.frame = frame;
            pattern.box = box;
            pattern.position = uniform_points(side, particles, static_cast<std::uint64_t>(frame));
            std::vector<int> cells(static_cast<std::size_t>(cells_a_side * cells_a_side));
            for (const Vec2 p : pattern.position) {
                ++cells[static_cast<std::size_t>(static_cast<int>(p.y / step) * cells_a_side +
                                                 static_cast<int>(p.x / step))];
            }
            add_contents(cells, cells_a_side, m, contents);
            ours.add(ours.measure(pattern));
        }
        const double truth = two_pass_variance(contents);
        const auto error = [&](const char* series, double variance, double right) {
            print_row("window", series, 1 - window / side, std::abs(variance / right - 1));
        };
        const ObservableResult result = ours.result();
        const Curve& pooled = *result.find_curve("variance_pooled");
        error("ours, counted", pooled.find("variance")->values.at(0), truth);
        error("naive, sums of squares, double", plain_variance<double>(contents), truth);
        error("naive, sums of squares, float", plain_variance<float>(contents), truth);
        const double share = window * window / (side * side);
        const double binomial = particles * share * (1 - share);
        const SpectrumModel flat =
            SpectrumModel::of_measured({{1.0, 2.0}, {1, 1}, {100, 100}, {0, 0}}, std::nullopt);
        const double density = particles / (side * side);
        error("ours, from S(k) in the box",
              synthetic_variance(flat, density, side, {window}).at(0).variance, binomial);
        error("naive, from S(k) without the box", particles * share, binomial);
    }
}

}  // namespace

int main(int argc, char** argv) {
    return bench::print_plots(argc, argv,
                              {{"offset", spectrum_far_away},
                               {"caged", caged_grains},
                               {"window", windows_as_large_as_the_box}});
}
