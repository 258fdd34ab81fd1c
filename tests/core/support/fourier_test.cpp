#include "core/support/fourier.h"

#include <cmath>
#include <complex>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/support/random.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;

template <class Real>
void fill_with_noise(RealFourier2D<Real>& fourier) {
    RandomStream random(1, "fourier test");
    for (Real& value : fourier.real()) value = static_cast<Real>(random.normal());
}

template <class Real>
std::complex<double> brute_force(const std::vector<Real>& f, int nx, int ny, int kx, int ky) {
    std::complex<double> sum = 0;
    for (int y = 0; y < ny; ++y) {
        for (int x = 0; x < nx; ++x) {
            const double turns =
                static_cast<double>(kx * x) / nx + static_cast<double>(ky * y) / ny;
            const auto i = static_cast<std::size_t>(y * nx + x);
            sum += static_cast<double>(f[i]) * std::polar(1.0, -2 * std::numbers::pi * turns);
        }
    }
    return sum;
}

template <class Real>
class FourierOf : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(FourierOf, Reals);

// Rounding of a sum of n unit-variance terms: error ≤ eps · log2(n) · sqrt(n) for the fast
// transform, so 8 eps sqrt(n) log2(n) leaves an order of magnitude.
template <class Real>
double tolerance(int nx, int ny) {
    const double n = nx * ny;
    return 8 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * std::sqrt(n) *
           (std::log2(n) + 1);
}

TYPED_TEST(FourierOf, AnyShapeEqualsTheBruteForceSum) {
    for (const auto& [nx, ny] : {std::pair{1, 1}, {8, 6}, {7, 5}, {12, 1}, {1, 9}, {11, 13}}) {
        RealFourier2D<TypeParam> fourier(nx, ny);
        fill_with_noise(fourier);
        const std::vector<TypeParam> f(fourier.real().begin(), fourier.real().end());
        fourier.forward();
        for (int ky = 0; ky < ny; ++ky) {
            for (int kx = 0; kx <= nx / 2; ++kx) {
                const auto i = static_cast<std::size_t>(ky * (nx / 2 + 1) + kx);
                const auto fast = fourier.complex()[i];
                const auto slow = brute_force(f, nx, ny, kx, ky);
                EXPECT_NEAR(static_cast<double>(fast.real()), slow.real(),
                            tolerance<TypeParam>(nx, ny));
                EXPECT_NEAR(static_cast<double>(fast.imag()), slow.imag(),
                            tolerance<TypeParam>(nx, ny));
            }
        }
    }
}

TYPED_TEST(FourierOf, BackwardAfterForwardMultipliesByTheNumberOfPoints) {
    const int nx = 90, ny = 35;
    RealFourier2D<TypeParam> fourier(nx, ny);
    fill_with_noise(fourier);
    const std::vector<TypeParam> f(fourier.real().begin(), fourier.real().end());
    fourier.forward();
    fourier.backward();
    for (std::size_t i = 0; i < f.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(fourier.real()[i]) / (nx * ny), static_cast<double>(f[i]),
                    tolerance<TypeParam>(nx, ny) / nx);
    }
}

template <class Real>
std::vector<std::complex<Real>> transformed_noise(FourierPlanning planning, int threads) {
    RealFourier2D<Real> fourier(252, 180, planning, threads);
    fill_with_noise(fourier);
    fourier.forward();
    return {fourier.complex().begin(), fourier.complex().end()};
}

TYPED_TEST(FourierOf, EstimatedPlansGiveTheSameBitsEveryTimeWhateverWasMeasuredBefore) {
    const auto first = transformed_noise<TypeParam>(FourierPlanning::estimate, 1);
    const auto again = transformed_noise<TypeParam>(FourierPlanning::estimate, 1);
    const auto threaded = transformed_noise<TypeParam>(FourierPlanning::estimate, 4);
    const auto measured = transformed_noise<TypeParam>(FourierPlanning::measure, 2);
    const auto later = transformed_noise<TypeParam>(FourierPlanning::estimate, 1);
    const std::size_t bytes = first.size() * sizeof(first[0]);
    EXPECT_EQ(std::memcmp(first.data(), again.data(), bytes), 0);
    EXPECT_EQ(std::memcmp(first.data(), threaded.data(), bytes), 0);
    EXPECT_EQ(std::memcmp(first.data(), later.data(), bytes), 0);
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(std::abs(first[i] - measured[i])), 0,
                    tolerance<TypeParam>(252, 180));
    }
}

TYPED_TEST(FourierOf, MovedTransformKeepsItsArrays) {
    RealFourier2D<TypeParam> source(6, 4);
    source.real()[5] = TypeParam{3};
    RealFourier2D<TypeParam> target(std::move(source));
    EXPECT_EQ(target.nx(), 6);
    EXPECT_EQ(target.ny(), 4);
    EXPECT_EQ(target.real()[5], TypeParam{3});
    EXPECT_EQ(target.complex().size(), 16U);
}

TYPED_TEST(FourierOf, SizesBelowOneAreRefused) {
    EXPECT_THROW(RealFourier2D<TypeParam>(0, 4), OptionError);
    EXPECT_THROW(RealFourier2D<TypeParam>(4, -1), OptionError);
}

TEST(FourierWisdom, IsKeptInTheCacheFolderAfterMeasuringAndWithoutLeftovers) {
    // main() below points XDG_CACHE_HOME to a fresh folder.
    RealFourier2D<double>(60, 40, FourierPlanning::measure);
    RealFourier2D<float>(60, 40, FourierPlanning::measure);
    const fs::path folder = fs::path(getenv("XDG_CACHE_HOME")) / "grainfield";
    EXPECT_GT(fs::file_size(folder / "fftw3.wisdom"), 50U);
    EXPECT_GT(fs::file_size(folder / "fftw3f.wisdom"), 50U);
    for (const auto& entry : fs::directory_iterator(folder)) {
        EXPECT_EQ(entry.path().extension(), ".wisdom") << entry.path();
    }
}

TEST(FourierWisdom, AFolderThatCannotBeMadeIsNoError) {
    const std::string before = getenv("XDG_CACHE_HOME");
    const fs::path file = fs::path(before) / "a-file";
    std::ofstream(file) << "not a folder";
    setenv("XDG_CACHE_HOME", file.c_str(), 1);
    EXPECT_NO_THROW(RealFourier2D<double>(61, 43, FourierPlanning::measure));
    setenv("XDG_CACHE_HOME", before.c_str(), 1);
}

TEST(FastFourierSize, IsTheSmallestProductOfTwoThreeFiveAndSeven) {
    EXPECT_EQ(fast_fourier_size(-3), 1);
    EXPECT_EQ(fast_fourier_size(11), 12);
    EXPECT_EQ(fast_fourier_size(1001), 1008);  // 2^4 · 3^2 · 7
    EXPECT_EQ(fast_fourier_size(1012), 1024);
    EXPECT_EQ(fast_fourier_size(1600), 1600);
}

}  // namespace
}  // namespace grainfield

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    const std::string folder =
        testing::TempDir() + "grainfield-fourier-" + std::to_string(getpid());
    if (!std::filesystem::create_directory(folder)) return 1;
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    const int failed = RUN_ALL_TESTS();
    std::filesystem::remove_all(folder);
    return failed;
}
