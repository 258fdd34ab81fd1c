#include "tracking/detect/disc_correlation.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {
namespace {

int padded(int n, const DiscProfile& disc) {
    return fast_fourier_size(n + static_cast<int>(std::ceil(disc.reach())) + 1);
}

}  // namespace

DiscCorrelation::DiscCorrelation(int width, int height, const DiscProfile& disc)
    : width_(width), height_(height), fourier_(padded(width, disc), padded(height, disc)) {
    for (int power = 1; power <= 3; ++power) kernel_[power - 1] = kernel_spectrum(disc, power);
    const int half = static_cast<int>(std::ceil(disc.reach()));
    for (int y = -half; y <= half; ++y) {
        for (int x = -half; x <= half; ++x) {
            const double p = disc.darkness(std::hypot(x, y));
            full_gain_ += p * p;
        }
    }
}

/// Transform of P^power centred on the origin, already divided by the FFT's normalisation. P is
/// even, so correlation and convolution agree and the spectrum is real up to rounding.
DiscCorrelation::Spectrum DiscCorrelation::kernel_spectrum(const DiscProfile& disc, int power) {
    const int nx = fourier_.nx();
    const int ny = fourier_.ny();
    auto real = fourier_.real();
    std::fill(real.begin(), real.end(), 0.0F);
    const int half = static_cast<int>(std::ceil(disc.reach()));
    const double scale = 1.0 / (static_cast<double>(nx) * static_cast<double>(ny));
    for (int y = -half; y <= half; ++y) {
        for (int x = -half; x <= half; ++x) {
            const double p = std::pow(disc.darkness(std::hypot(x, y)), power);
            const std::size_t index =
                static_cast<std::size_t>((y + ny) % ny) * static_cast<std::size_t>(nx) +
                static_cast<std::size_t>((x + nx) % nx);
            real[index] += static_cast<float>(p * scale);
        }
    }
    fourier_.forward();
    const auto spectrum = fourier_.complex();
    return {spectrum.begin(), spectrum.end()};
}

/// Puts image · factor into the padded array.
void DiscCorrelation::load(const Image& image, const Image* factor) {
    auto real = fourier_.real();
    const auto nx = static_cast<std::size_t>(fourier_.nx());
    std::fill(real.begin(), real.end(), 0.0F);
    for (int y = 0; y < height_; ++y) {
        float* out = real.data() + static_cast<std::size_t>(y) * nx;
        const float* in = image.row(y);
        if (factor == nullptr) {
            std::copy_n(in, width_, out);
        } else {
            const float* by = factor->row(y);
            for (int x = 0; x < width_; ++x) out[x] = in[x] * by[x];
        }
    }
}

Image DiscCorrelation::crop() {
    Image map(width_, height_);
    const auto real = fourier_.real();
    const auto nx = static_cast<std::size_t>(fourier_.nx());
    for (int y = 0; y < height_; ++y) {
        std::copy_n(real.data() + static_cast<std::size_t>(y) * nx, width_, map.row(y));
    }
    return map;
}

Image DiscCorrelation::chi_squared(const Image& darkness) {
    if (norm_.empty()) {
        load(Image(width_, height_, 1.0F), nullptr);
        fourier_.forward();
        auto spectrum = fourier_.complex();
        for (std::size_t i = 0; i < spectrum.size(); ++i) spectrum[i] *= kernel_[2][i];
        fourier_.backward();
        norm_ = crop();
    }
    load(darkness, &darkness);
    fourier_.forward();
    auto spectrum = fourier_.complex();
    sum_.resize(spectrum.size());
    for (std::size_t i = 0; i < spectrum.size(); ++i) sum_[i] = spectrum[i] * kernel_[0][i];
    load(darkness, nullptr);
    fourier_.forward();
    spectrum = fourier_.complex();
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        spectrum[i] = sum_[i] - 2.0F * spectrum[i] * kernel_[1][i];
    }
    fourier_.backward();
    Image map = crop();
    for (std::size_t i = 0; i < map.size(); ++i) {
        map.pixels()[i] = 1.0F + map.pixels()[i] / norm_.pixels()[i];
    }
    return map;
}

Image DiscCorrelation::gain(const Image& darkness, const Image& transmission) {
    Image product(width_, height_);
    for (std::size_t i = 0; i < product.size(); ++i) {
        const float t = transmission.pixels()[i];
        product.pixels()[i] = (darkness.pixels()[i] - 1.0F + t) * t;
    }
    load(product, nullptr);
    fourier_.forward();
    auto spectrum = fourier_.complex();
    sum_.resize(spectrum.size());
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        sum_[i] = 2.0F * spectrum[i] * kernel_[0][i];
    }
    load(transmission, &transmission);
    fourier_.forward();
    spectrum = fourier_.complex();
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        spectrum[i] = sum_[i] - spectrum[i] * kernel_[1][i];
    }
    fourier_.backward();
    return crop();
}

}  // namespace grainfield::tracking
