#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>

namespace grainfield {

/// How FFTW chooses its algorithm. `estimate` picks the same one on every run (bit-reproducible
/// results, also for any number of threads: such plans are serial); `measure` times candidates once
/// and keeps the wisdom in the user's cache folder
/// ($XDG_CACHE_HOME/grainfield, else ~/.cache/grainfield): 20–25 % faster, not bit-reproducible.
enum class FourierPlanning { estimate, measure };

/// Two-dimensional real ↔ complex Fourier transform of a fixed size, Real = float or double.
///
///   F(kx, ky) = Σ_{x,y} f(x, y) exp(−2πi (kx x/nx + ky y/ny)),  no normalisation,
///   backward(forward(f)) = nx · ny · f.
///
/// The real array is row-major, ny rows of nx; the half-complex array is ny rows of nx/2 + 1.
/// The transform owns its aligned arrays: fill `real()`, call `forward()`, read `complex()`, and
/// the other way round. `backward` destroys the content of `complex()`.
/// FFTW (`frigo2005`), O(n log n). Construction is serialised internally; transforms of different
/// objects may run at the same time in different threads.
template <class Real>
class RealFourier2D {
 public:
    RealFourier2D(int nx, int ny, FourierPlanning planning = FourierPlanning::estimate,
                  int threads = 1);
    ~RealFourier2D();
    RealFourier2D(RealFourier2D&&) noexcept;
    RealFourier2D& operator=(RealFourier2D&&) noexcept;

    int nx() const;
    int ny() const;
    std::span<Real> real();
    std::span<std::complex<Real>> complex();
    void forward();
    void backward();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

extern template class RealFourier2D<float>;
extern template class RealFourier2D<double>;

/// The smallest n' ≥ n of the form 2^a 3^b 5^c 7^d, for which FFTW is fast.
int fast_fourier_size(int n);

}  // namespace grainfield
