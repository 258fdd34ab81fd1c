#pragma once

#include <complex>
#include <memory>
#include <span>

namespace grainfield {

/// One-dimensional complex Fourier transform of a fixed length, backward (plus sign):
///
///   f(x) = Σ_k F(k) exp(+2πi k x/n),  no normalisation.
///
/// One plan serves any number of lines and threads: `backward` is const and safe to call from many
/// threads at once. FFTW (`frigo2005`) with estimated plans, so the bits depend on the input and
/// the machine only. Where lines are cut out of larger arrays, keep their starts `alignment`
/// apart.
template <class Real>
class LineFourier {
 public:
    explicit LineFourier(int n);
    ~LineFourier();
    LineFourier(LineFourier&&) noexcept;
    LineFourier& operator=(LineFourier&&) noexcept;

    /// Complex numbers between the starts of lines: a multiple of this, from an AlignedVector.
    static constexpr int alignment = 8;

    int size() const;
    /// `in` and `out` hold size() numbers each and do not overlap; `in` is kept.
    void backward(const std::complex<Real>* in, std::complex<Real>* out) const;

 private:
    struct State;
    std::unique_ptr<State> state_;
};

extern template class LineFourier<float>;
extern template class LineFourier<double>;

}  // namespace grainfield
