#include "tracking/synthesis/moment_sums.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "core/frame.h"
#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr int kAngles = 24;
constexpr std::array<float, MomentSums::kRings> kRadii = {1.5F, 3, 4.5F, 6, 7.5F, 9, 11};
constexpr float kX = 20.3F;
constexpr float kY = 21.6F;

Image random_image(const char* name) {
    Image image(43, 41);
    RandomStream random(5, name);
    for (float& v : image.pixels()) v = static_cast<float>(random.normal());
    return image;
}

double between(const Image& image, double x, double y) {
    const int u = std::clamp(static_cast<int>(std::floor(x)), 0, image.width() - 2);
    const int v = std::clamp(static_cast<int>(std::floor(y)), 0, image.height() - 2);
    const auto at = [&](int i, int j) { return static_cast<double>(image(u + i, v + j)); };
    const double upper = std::lerp(at(0, 0), at(1, 0), x - u);
    const double lower = std::lerp(at(0, 1), at(1, 1), x - u);
    return std::lerp(upper, lower, y - v);
}

/// ⟨f e^{imθ}⟩ as it is written.
std::complex<double> moment(const Image& image, double radius, int m) {
    std::complex<double> sum = 0;
    for (int k = 0; k < kAngles; ++k) {
        const double angle = 2 * std::numbers::pi * k / kAngles;
        sum += between(image, static_cast<double>(kX) + radius * std::cos(angle),
                       static_cast<double>(kY) + radius * std::sin(angle)) *
               std::polar(1.0, m * angle);
    }
    return sum / double{kAngles};
}

void expect_moments(const MomentSums::Moments& h, const Image& darkness, const Image& residual) {
    for (int m = 0; m < static_cast<int>(MomentSums::kOrders); ++m) {
        for (std::size_t ring = 0; ring < kRadii.size(); ++ring) {
            const auto radius = static_cast<double>(kRadii[ring]);
            const std::complex<double> left = moment(residual, radius, m);
            const std::complex<double> dark = moment(darkness, radius, m);
            const auto order = static_cast<std::size_t>(m);
            // Single precision; places are known to 1e-6 px, where the image changes by about one
            // a pixel.
            EXPECT_NEAR(static_cast<double>(h.real[order][ring]), left.real(), 1e-5);
            EXPECT_NEAR(static_cast<double>(h.imaginary[order][ring]), left.imag(), 1e-5);
            const std::size_t second = MomentSums::kLanes + ring;
            EXPECT_NEAR(static_cast<double>(h.real[order][second]), dark.real(), 1e-5);
            EXPECT_NEAR(static_cast<double>(h.imaginary[order][second]), dark.imag(), 1e-5);
        }
    }
}

TEST(MomentSums, AreMeansOverTheRings) {
    const Image darkness = random_image("darkness");
    const Image residual = random_image("residual");
    expect_moments(MomentSums::moments(PixelRows::of(darkness), PixelRows::of(residual), false,
                                       kRadii, kX, kY),
                   darkness, residual);
}

TEST(MomentSums, OfAFitTakeItsResidual) {
    const Image darkness = random_image("darkness");
    const Image transmission = random_image("transmission");
    Image residual(darkness.width(), darkness.height());
    for (std::size_t i = 0; i < residual.pixels().size(); ++i) {
        residual.pixels()[i] = darkness.pixels()[i] - 1 + transmission.pixels()[i];
    }
    expect_moments(MomentSums::moments(PixelRows::of(darkness), PixelRows::of(transmission), true,
                                       kRadii, kX, kY),
                   darkness, residual);
}

TEST(MomentSums, AreReadAtTheBorderFromTheLastPixels) {
    Image plane(43, 41);
    for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) plane(x, y) = static_cast<float>(x + 2 * y);
    }
    // A ring that ends on the last column and row: a plane is exact between pixels.
    constexpr std::array<float, MomentSums::kRings> kWide = {1, 2, 3, 4, 5, 6, 11};
    const MomentSums::Moments h =
        MomentSums::moments(PixelRows::of(plane), PixelRows::of(plane), false, kWide, 31, 29);
    EXPECT_NEAR(static_cast<double>(h.real[0][6]), 31 + 2 * 29, 1e-4);
    EXPECT_NEAR(static_cast<double>(h.real[1][6]), 11 / 2.0, 1e-4);
    EXPECT_NEAR(static_cast<double>(h.imaginary[1][6]), 11.0, 1e-4);
}

TEST(MomentSums, WeightedIsTheSumOfProducts) {
    RandomStream random(6, "numbers");
    MomentSums::Moments h;
    MomentSums::Weights weights;
    for (auto* part : {&h.real, &h.imaginary}) {
        for (auto& order : *part) {
            for (float& v : order) v = static_cast<float>(random.normal());
        }
    }
    for (float& v : weights.first) v = static_cast<float>(random.normal());
    for (auto& order : weights.product) {
        for (auto& row : order) {
            for (float& v : row) v = static_cast<float>(random.normal());
        }
    }
    const auto value = [&](std::size_t m, std::size_t s) {
        return std::complex<double>(static_cast<double>(h.real[m][s]),
                                    static_cast<double>(h.imaginary[m][s]));
    };
    std::complex<double> sum = 0;
    double size = 0;
    for (std::size_t q = 0; q < MomentSums::kSources; ++q) {
        sum += static_cast<double>(weights.first[q]) * value(1, q);
        for (std::size_t m = 0; m + 1 < MomentSums::kOrders; ++m) {
            for (std::size_t p = 0; p < MomentSums::kSources; ++p) {
                const std::complex<double> term = static_cast<double>(weights.product[m][p][q]) *
                                                  value(m + 1, p) * std::conj(value(m, q));
                sum += term;
                size += std::abs(term);
            }
        }
    }
    const MomentSums::Sum found = MomentSums::weighted(h, weights);
    EXPECT_NEAR(static_cast<double>(found.x), sum.real(), 1e-6 * size);
    EXPECT_NEAR(static_cast<double>(found.y), sum.imag(), 1e-6 * size);
    EXPECT_GT(std::abs(sum), 1e-3 * size);
}

}  // namespace
}  // namespace grainfield::tracking
