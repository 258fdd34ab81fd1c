#include "tracking/detect/disc_correlation.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {
namespace {

constexpr int kBlocksPerDiameter = 7;
constexpr int kLargestFactor = 8;
/// Share of a disc below which it says nothing.
constexpr double kLeastVisible = 0.02;
/// Share of the image above which transforms of all of it are cheaper than sums in the places.
constexpr double kFewPlaces = 0.2;

int blocks(int n, int factor) {
    return (n + factor - 1) / factor;
}

int padded(int n, const DiscProfile& disc, int factor) {
    return fast_fourier_size(blocks(n, factor) +
                             static_cast<int>(std::ceil(disc.reach() / factor)) + 1);
}

/// Sums over blocks of two functions of the pixels, divided by the area of a full block.
template <class Pixel>
std::pair<Image, Image> block_means(int width, int height, int factor, Pixel&& pixel) {
    std::pair<Image, Image> means{Image(blocks(width, factor), blocks(height, factor)),
                                  Image(blocks(width, factor), blocks(height, factor))};
    const auto columns =
        static_cast<std::size_t>(means.first.width()) * static_cast<std::size_t>(factor);
    std::vector<float> a(columns);
    std::vector<float> b(columns);
    const float share = 1.0F / static_cast<float>(factor * factor);
    for (int row = 0; row < means.first.height(); ++row) {
        std::fill(a.begin(), a.end(), 0.0F);
        std::fill(b.begin(), b.end(), 0.0F);
        for (int y = row * factor; y < std::min(height, (row + 1) * factor); ++y) {
            pixel(y, a.data(), b.data());
        }
        float* first = means.first.row(row);
        float* second = means.second.row(row);
        for (int x = 0; x < means.first.width(); ++x) {
            float sum_a = 0;
            float sum_b = 0;
            for (int i = x * factor; i < (x + 1) * factor; ++i) {
                sum_a += a[static_cast<std::size_t>(i)];
                sum_b += b[static_cast<std::size_t>(i)];
            }
            first[x] = sum_a * share;
            second[x] = sum_b * share;
        }
    }
    return means;
}

}  // namespace

int DiscCorrelation::suitable_factor(const DiscProfile& disc) {
    return std::clamp(static_cast<int>(disc.diameter) / kBlocksPerDiameter, 1, kLargestFactor);
}

DiscCorrelation::DiscCorrelation(int width, int height, const DiscProfile& disc, int factor)
    : factor_(factor),
      pixels_x_(width),
      pixels_y_(height),
      width_(blocks(width, factor)),
      height_(blocks(height, factor)),
      fourier_(padded(width, disc, factor), padded(height, disc, factor)),
      half_(half_width(disc)) {
    for (int power = 1; power <= 2; ++power) taps_[power - 1] = block_kernel(disc, power);
    for (int power = 1; power <= 3; ++power) kernel_[power - 1] = kernel_spectrum(disc, power);
    const int half = static_cast<int>(std::ceil(disc.reach()));
    for (int y = -half; y <= half; ++y) {
        for (int x = -half; x <= half; ++x) {
            const double p = disc.darkness(std::hypot(x, y));
            full_gain_ += p * p;
        }
    }
    set_visible({});
}

bool DiscCorrelation::are_few(const std::vector<PixelBlock>& places) const {
    return area_of(places) <= kFewPlaces * pixels_x_ * pixels_y_;
}

void DiscCorrelation::set_visible(const VisiblePixels& visible) {
    // Pixels beyond the border count as absent, not as background.
    const auto inside = block_means(pixels_x_, pixels_y_, factor_, [&](int y, float* a, float*) {
        for (int x = 0; x < pixels_x_; ++x) a[x] += visible(x, y) ? 1.0F : 0.0F;
    });
    transform(inside.first);
    const auto spectrum = fourier_.complex();
    for (std::size_t i = 0; i < spectrum.size(); ++i) spectrum[i] *= kernel_[2][i];
    fourier_.backward();
    norm_ = Image(width_, height_);
    for (int y = 0; y < height_; ++y) {
        std::copy_n(fourier_.real().data() +
                        static_cast<std::size_t>(y) * static_cast<std::size_t>(fourier_.nx()),
                    width_, norm_.row(y));
    }
}

int DiscCorrelation::half_width(const DiscProfile& disc) const {
    return static_cast<int>(std::ceil(disc.reach() / factor_));
}

/// P^power about the origin, summed over the pixels of each block.
std::vector<float> DiscCorrelation::block_kernel(const DiscProfile& disc, int power) const {
    const int half = half_width(disc);
    const double centre = 0.5 * (factor_ - 1);
    std::vector<float> taps;
    for (int y = -half; y <= half; ++y) {
        for (int x = -half; x <= half; ++x) {
            double p = 0;
            for (int v = 0; v < factor_; ++v) {
                for (int u = 0; u < factor_; ++u) {
                    p += std::pow(disc.darkness(std::hypot(x * factor_ + u - centre,
                                                           y * factor_ + v - centre)),
                                  power);
                }
            }
            taps.push_back(static_cast<float>(p));
        }
    }
    return taps;
}

/// Its transform, with the normalisation of the FFT.
std::vector<float> DiscCorrelation::kernel_spectrum(const DiscProfile& disc, int power) {
    const int nx = fourier_.nx();
    const int ny = fourier_.ny();
    auto real = fourier_.real();
    std::fill(real.begin(), real.end(), 0.0F);
    const double scale = 1.0 / (static_cast<double>(nx) * static_cast<double>(ny));
    const std::vector<float> taps = block_kernel(disc, power);
    auto tap = taps.begin();
    for (int y = -half_; y <= half_; ++y) {
        for (int x = -half_; x <= half_; ++x, ++tap) {
            const std::size_t index =
                static_cast<std::size_t>((y + ny) % ny) * static_cast<std::size_t>(nx) +
                static_cast<std::size_t>((x + nx) % nx);
            real[index] += static_cast<float>(static_cast<double>(*tap) * scale);
        }
    }
    fourier_.forward();
    const auto spectrum = fourier_.complex();
    std::vector<float> even(spectrum.size());
    std::transform(spectrum.begin(), spectrum.end(), even.begin(),
                   [](std::complex<float> value) { return value.real(); });
    return even;
}

void DiscCorrelation::transform(const Image& blocks) {
    auto real = fourier_.real();
    const auto nx = static_cast<std::size_t>(fourier_.nx());
    for (int y = 0; y < height_; ++y) {
        float* out = real.data() + static_cast<std::size_t>(y) * nx;
        std::copy_n(blocks.row(y), width_, out);
        std::fill(out + width_, out + nx, 0.0F);
    }
    std::fill(real.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(height_) * nx),
              real.end(), 0.0F);
    fourier_.forward();
}

Image DiscCorrelation::correlate(const Blocks& blocks, float scale_first, float scale_second) {
    transform(blocks.first);
    auto spectrum = fourier_.complex();
    sum_.resize(spectrum.size());
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        sum_[i] = spectrum[i] * (scale_first * kernel_[0][i]);
    }
    transform(blocks.second);
    spectrum = fourier_.complex();
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        spectrum[i] = sum_[i] + spectrum[i] * (scale_second * kernel_[1][i]);
    }
    fourier_.backward();
    Image map(width_, height_);
    const auto nx = static_cast<std::size_t>(fourier_.nx());
    for (int y = 0; y < height_; ++y) {
        std::copy_n(fourier_.real().data() + static_cast<std::size_t>(y) * nx, width_, map.row(y));
    }
    return map;
}

Image DiscCorrelation::chi_squared(const PaddedImage& darkness, const PaddedImage& transmission) {
    auto [squares, values] =
        block_means(darkness.width(), darkness.height(), factor_, [&](int y, float* a, float* b) {
            const float* d = darkness.row(y);
            const float* t = transmission.row(y);
            for (int x = 0; x < darkness.width(); ++x) {
                const float seen = t[x] > 0 ? d[x] : 0.0F;
                a[x] += seen * d[x];
                b[x] += seen;
            }
        });
    Image map = correlate({std::move(squares), std::move(values)}, 1, -2);
    // Rounding of the transforms is all that is left where hardly anything is visible.
    const auto least = static_cast<float>(kLeastVisible * full_gain_);
    for (std::size_t i = 0; i < map.size(); ++i) {
        const float norm = norm_.pixels()[i];
        map.pixels()[i] = norm > least ? 1.0F + map.pixels()[i] / norm : 1.0F;
    }
    return map;
}

Image DiscCorrelation::gain(const PaddedImage& darkness, const PaddedImage& transmission) {
    auto [products, squares] =
        block_means(darkness.width(), darkness.height(), factor_, [&](int y, float* a, float* b) {
            const float* d = darkness.row(y);
            const float* t = transmission.row(y);
            for (int x = 0; x < darkness.width(); ++x) {
                a[x] += (d[x] - 1.0F + t[x]) * t[x];
                b[x] += t[x] * t[x];
            }
        });
    return correlate({std::move(products), std::move(squares)}, 2, -1);
}

/// G on a part of the map: the sums that correlate() takes by way of the transforms.
void DiscCorrelation::add_gain(const PixelBlock& part, const PaddedImage& darkness,
                               const PaddedImage& transmission, Image& map) const {
    const int columns = part.x1 - part.x0 + 2 * half_;
    const int rows = part.y1 - part.y0 + 2 * half_;
    Image products(columns, rows);
    Image squares(columns, rows);
    const float share = 1.0F / static_cast<float>(factor_ * factor_);
    const int first_x = (part.x0 - half_) * factor_;
    const int first_y = (part.y0 - half_) * factor_;
    for (int y = std::max(0, first_y); y < std::min(darkness.height(), first_y + rows * factor_);
         ++y) {
        const float* d = darkness.row(y);
        const float* t = transmission.row(y);
        float* product = products.row((y - first_y) / factor_);
        float* square = squares.row((y - first_y) / factor_);
        for (int x = std::max(0, first_x);
             x < std::min(darkness.width(), first_x + columns * factor_); ++x) {
            const int at = (x - first_x) / factor_;
            product[at] += share * (d[x] - 1.0F + t[x]) * t[x];
            square[at] += share * t[x] * t[x];
        }
    }
    for (int y = part.y0; y < part.y1; ++y) {
        float* out = map.row(y) + part.x0;
        std::fill(out, out + (part.x1 - part.x0), 0.0F);
        std::size_t tap = 0;
        for (int v = 0; v <= 2 * half_; ++v) {
            const float* product = products.row(y - part.y0 + v);
            const float* square = squares.row(y - part.y0 + v);
            for (int u = 0; u <= 2 * half_; ++u, ++tap) {
                const float first = 2 * taps_[0][tap];
                const float second = taps_[1][tap];
#pragma omp simd
                for (int x = 0; x < part.x1 - part.x0; ++x) {
                    out[x] += first * product[x + u] - second * square[x + u];
                }
            }
        }
    }
}

const Image& DiscCorrelation::gain_in(const std::vector<PixelBlock>& places,
                                      const PaddedImage& darkness,
                                      const PaddedImage& transmission) {
    if (in_part_.size() == 0) in_part_ = Image(width_, height_);
    // Most of the map is zero, and has been before.
    for (const PixelBlock& part : parts_) {
        for (int y = part.y0; y < part.y1; ++y) {
            std::fill_n(in_part_.row(y) + part.x0, part.x1 - part.x0, 0.0F);
        }
    }
    parts_.clear();
    for (const PixelBlock& place : places) {
        // Its neighbours too, for the shape of peaks at the rim.
        parts_.push_back({std::max(0, place.x0 / factor_ - 1), std::max(0, place.y0 / factor_ - 1),
                          std::min(width_, (place.x1 - 1) / factor_ + 2),
                          std::min(height_, (place.y1 - 1) / factor_ + 2)});
        add_gain(parts_.back(), darkness, transmission, in_part_);
    }
    return in_part_;
}

}  // namespace grainfield::tracking
