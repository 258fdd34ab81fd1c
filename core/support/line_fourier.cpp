#include "core/support/line_fourier.h"

#include <mutex>
#include <new>

#include <fftw3.h>
#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/fftw_planner.h"

namespace grainfield {

namespace {

template <class Real>
struct Library;

template <>
struct Library<double> {
    using Complex = fftw_complex;
    using Plan = fftw_plan;
    static void forget_wisdom() { fftw_forget_wisdom(); }
    static void* allocate(std::size_t bytes) { return fftw_malloc(bytes); }
    static void release(void* p) { fftw_free(p); }
    static Plan plan(int n, Complex* in, Complex* out) {
        return fftw_plan_dft_1d(n, in, out, FFTW_BACKWARD, FFTW_ESTIMATE);
    }
    static void execute(Plan p, Complex* in, Complex* out) { fftw_execute_dft(p, in, out); }
    static void destroy(Plan p) { fftw_destroy_plan(p); }
};

template <>
struct Library<float> {
    using Complex = fftwf_complex;
    using Plan = fftwf_plan;
    static void forget_wisdom() { fftwf_forget_wisdom(); }
    static void* allocate(std::size_t bytes) { return fftwf_malloc(bytes); }
    static void release(void* p) { fftwf_free(p); }
    static Plan plan(int n, Complex* in, Complex* out) {
        return fftwf_plan_dft_1d(n, in, out, FFTW_BACKWARD, FFTW_ESTIMATE);
    }
    static void execute(Plan p, Complex* in, Complex* out) { fftwf_execute_dft(p, in, out); }
    static void destroy(Plan p) { fftwf_destroy_plan(p); }
};

}  // namespace

template <class Real>
struct LineFourier<Real>::State {
    using L = Library<Real>;
    using Complex = typename L::Complex;

    explicit State(int length) : n(length) {
        if (n < 1) throw OptionError(fmt::format("a Fourier transform cannot have length {}.", n));
        // Planning an estimate touches no data; only the alignment of the arrays matters.
        const std::size_t bytes = static_cast<std::size_t>(n) * sizeof(Complex);
        auto* in = static_cast<Complex*>(L::allocate(bytes));
        auto* out = static_cast<Complex*>(L::allocate(bytes));
        if (in != nullptr && out != nullptr) {
            const std::lock_guard lock(fftw_planner_mutex());
            L::forget_wisdom();
            plan = L::plan(n, in, out);
        }
        L::release(in);
        L::release(out);
        if (plan == nullptr) throw std::bad_alloc();
    }
    ~State() {
        const std::lock_guard lock(fftw_planner_mutex());
        L::destroy(plan);
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    int n;
    typename L::Plan plan = nullptr;
};

template <class Real>
LineFourier<Real>::LineFourier(int n) : state_(std::make_unique<State>(n)) {}
template <class Real>
LineFourier<Real>::~LineFourier() = default;
template <class Real>
LineFourier<Real>::LineFourier(LineFourier&&) noexcept = default;
template <class Real>
LineFourier<Real>& LineFourier<Real>::operator=(LineFourier&&) noexcept = default;

template <class Real>
int LineFourier<Real>::size() const {
    return state_->n;
}

template <class Real>
void LineFourier<Real>::backward(const std::complex<Real>* in, std::complex<Real>* out) const {
    using Complex = typename State::Complex;
    // FFTW keeps the input of an out-of-place complex transform, though its type does not say so.
    Library<Real>::execute(state_->plan,
                           reinterpret_cast<Complex*>(const_cast<std::complex<Real>*>(in)),
                           reinterpret_cast<Complex*>(out));
}

template class LineFourier<float>;
template class LineFourier<double>;

}  // namespace grainfield
