#include "core/support/fourier.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <system_error>

#include <fftw3.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/support/fftw_planner.h"
#include "core/support/parallel.h"

namespace grainfield {

std::mutex& fftw_planner_mutex() {
    static std::mutex mutex;
    return mutex;
}

namespace {

// The jobs of a threaded plan, on our threads.
void run_jobs(void* (*work)(char*), char* jobs, std::size_t job_size, int count, void*) {
    parallel_for(count, count, [&](std::int64_t i) {
        static_cast<void>(work(jobs + job_size * static_cast<std::size_t>(i)));
    });
}

template <class Real>
struct Fftw;

template <>
struct Fftw<double> {
    using Complex = fftw_complex;
    using Plan = fftw_plan;
    static constexpr const char* wisdom_file = "fftw3.wisdom";
    static void* allocate(std::size_t bytes) { return fftw_malloc(bytes); }
    static void release(void* p) { fftw_free(p); }
    static void init_threads() {
        fftw_init_threads();
        fftw_threads_set_callback(run_jobs, nullptr);
    }
    static void use_threads(int n) { fftw_plan_with_nthreads(n); }
    static void forget_wisdom() { fftw_forget_wisdom(); }
    static char* export_wisdom() { return fftw_export_wisdom_to_string(); }
    static void import_wisdom(const char* s) { fftw_import_wisdom_from_string(s); }
    static void destroy(Plan p) { fftw_destroy_plan(p); }
    static void execute(Plan p) { fftw_execute(p); }
    static Plan plan_forward(int ny, int nx, double* in, Complex* out, unsigned flags) {
        return fftw_plan_dft_r2c_2d(ny, nx, in, out, flags);
    }
    static Plan plan_backward(int ny, int nx, Complex* in, double* out, unsigned flags) {
        return fftw_plan_dft_c2r_2d(ny, nx, in, out, flags);
    }
};

template <>
struct Fftw<float> {
    using Complex = fftwf_complex;
    using Plan = fftwf_plan;
    static constexpr const char* wisdom_file = "fftw3f.wisdom";
    static void* allocate(std::size_t bytes) { return fftwf_malloc(bytes); }
    static void release(void* p) { fftwf_free(p); }
    static void init_threads() {
        fftwf_init_threads();
        fftwf_threads_set_callback(run_jobs, nullptr);
    }
    static void use_threads(int n) { fftwf_plan_with_nthreads(n); }
    static void forget_wisdom() { fftwf_forget_wisdom(); }
    static char* export_wisdom() { return fftwf_export_wisdom_to_string(); }
    static void import_wisdom(const char* s) { fftwf_import_wisdom_from_string(s); }
    static void destroy(Plan p) { fftwf_destroy_plan(p); }
    static void execute(Plan p) { fftwf_execute(p); }
    static Plan plan_forward(int ny, int nx, float* in, Complex* out, unsigned flags) {
        return fftwf_plan_dft_r2c_2d(ny, nx, in, out, flags);
    }
    static Plan plan_backward(int ny, int nx, Complex* in, float* out, unsigned flags) {
        return fftwf_plan_dft_c2r_2d(ny, nx, in, out, flags);
    }
};

std::optional<std::filesystem::path> cache_folder() {
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg == '/') {
        return std::filesystem::path(xdg) / "grainfield";
    }
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
        return std::filesystem::path(home) / ".cache" / "grainfield";
    }
    return std::nullopt;
}

std::string load_wisdom(const char* name) {
    const auto folder = cache_folder();
    if (!folder) return {};
    std::ifstream file(*folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Wisdom only saves time, so a cache folder that cannot be written is no reason to complain.
void save_wisdom(const char* name, const std::string& wisdom) {
    const auto folder = cache_folder();
    if (!folder) return;
    std::error_code error;
    std::filesystem::create_directories(*folder, error);
    if (error) return;
    const auto temporary = *folder / fmt::format("{}.{}.tmp", name, ::getpid());
    {
        std::ofstream file(temporary, std::ios::binary);
        file << wisdom;
        file.close();
        if (!file) error = std::make_error_code(std::errc::io_error);
    }
    if (!error) std::filesystem::rename(temporary, *folder / name, error);
    if (error) std::filesystem::remove(temporary, error);
}

// FFTW consults accumulated wisdom even for estimates, which would make their rounding depend on
// what was measured before. So wisdom lives here and is handed to FFTW only while measuring.
template <class Real>
std::string& kept_wisdom() {
    static std::string wisdom = load_wisdom(Fftw<Real>::wisdom_file);
    return wisdom;
}

template <class Real>
void collect_wisdom() {
    char* text = Fftw<Real>::export_wisdom();
    if (text == nullptr) return;
    std::string wisdom(text);
    std::free(text);
    if (wisdom == kept_wisdom<Real>()) return;
    kept_wisdom<Real>() = wisdom;
    save_wisdom(Fftw<Real>::wisdom_file, wisdom);
}

void require_size(int n, char axis) {
    if (n >= 1) return;
    throw OptionError({.problem = fmt::format("Fourier transform size n{} is not usable", axis),
                       .actual = fmt::format("{}", n),
                       .expected = "at least 1",
                       .suggestion = {}});
}

}  // namespace

template <class Real>
struct RealFourier2D<Real>::State {
    using Library = Fftw<Real>;
    using Complex = typename Library::Complex;

    State(int width, int height, FourierPlanning planning, int threads)
        : nx(width),
          ny(height),
          real_size(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny)),
          complex_size((static_cast<std::size_t>(nx) / 2 + 1) * static_cast<std::size_t>(ny)) {
        real = static_cast<Real*>(Library::allocate(real_size * sizeof(Real)));
        complex = static_cast<Complex*>(Library::allocate(complex_size * sizeof(Complex)));
        if (real == nullptr || complex == nullptr) {
            release();
            throw std::bad_alloc();
        }
        make_plans(planning, threads);
        if (forward == nullptr || backward == nullptr) {
            release();
            throw Error(fmt::format("FFTW cannot plan a {} x {} transform.", nx, ny));
        }
        std::fill_n(real, real_size, Real{0});
        std::fill_n(&complex[0][0], 2 * complex_size, Real{0});
    }
    ~State() { release(); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void make_plans(FourierPlanning planning, int threads) {
        const std::lock_guard lock(fftw_planner_mutex());
        static const bool initialised = (Library::init_threads(), true);
        static_cast<void>(initialised);
        const bool measures = planning == FourierPlanning::measure;
        const unsigned flags = measures ? FFTW_MEASURE : FFTW_ESTIMATE;
        // A threaded plan may round differently from a serial one: estimates stay serial.
        Library::use_threads(measures ? std::max(threads, 1) : 1);
        Library::forget_wisdom();
        if (measures) Library::import_wisdom(kept_wisdom<Real>().c_str());
        forward = Library::plan_forward(ny, nx, real, complex, flags);
        backward = Library::plan_backward(ny, nx, complex, real, flags);
        if (measures) collect_wisdom<Real>();
    }

    void release() {
        const std::lock_guard lock(fftw_planner_mutex());
        if (forward != nullptr) Library::destroy(forward);
        if (backward != nullptr) Library::destroy(backward);
        Library::release(real);
        Library::release(complex);
    }

    int nx;
    int ny;
    std::size_t real_size;
    std::size_t complex_size;
    Real* real = nullptr;
    Complex* complex = nullptr;
    typename Library::Plan forward = nullptr;
    typename Library::Plan backward = nullptr;
};

template <class Real>
RealFourier2D<Real>::RealFourier2D(int nx, int ny, FourierPlanning planning, int threads) {
    require_size(nx, 'x');
    require_size(ny, 'y');
    state_ = std::make_unique<State>(nx, ny, planning, threads);
}

template <class Real>
RealFourier2D<Real>::~RealFourier2D() = default;
template <class Real>
RealFourier2D<Real>::RealFourier2D(RealFourier2D&&) noexcept = default;
template <class Real>
RealFourier2D<Real>& RealFourier2D<Real>::operator=(RealFourier2D&&) noexcept = default;

template <class Real>
int RealFourier2D<Real>::nx() const {
    return state_->nx;
}

template <class Real>
int RealFourier2D<Real>::ny() const {
    return state_->ny;
}

template <class Real>
std::span<Real> RealFourier2D<Real>::real() {
    return {state_->real, state_->real_size};
}

template <class Real>
std::span<std::complex<Real>> RealFourier2D<Real>::complex() {
    // FFTW guarantees that fftw_complex and std::complex have the same layout.
    return {reinterpret_cast<std::complex<Real>*>(state_->complex), state_->complex_size};
}

template <class Real>
void RealFourier2D<Real>::forward() {
    Fftw<Real>::execute(state_->forward);
}

template <class Real>
void RealFourier2D<Real>::backward() {
    Fftw<Real>::execute(state_->backward);
}

template class RealFourier2D<float>;
template class RealFourier2D<double>;

int fast_fourier_size(int n) {
    for (int size = std::max(n, 1);; ++size) {
        int rest = size;
        for (const int factor : {2, 3, 5, 7}) {
            while (rest % factor == 0) rest /= factor;
        }
        if (rest == 1) return size;
    }
}

}  // namespace grainfield
