#include "tracking/calibrate/first_guess.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "tracking/calibrate/background.h"

namespace grainfield::tracking {
namespace {

/// Contrast in units of the noise below which a frame is blank.
constexpr double kBlank = 7;

/// In an image in which spheres are dark.
std::vector<FirstGuess> guesses_for(const Image& counts, Polarity polarity, double dark_level,
                                    double contrast, double tolerance,
                                    const VisiblePixels& visible) {
    FirstGuess guess;
    guess.polarity = polarity;
    guess.background = upper_envelope(counts, contrast, tolerance, visible);
    guess.dark_level = dark_level;
    Image mask(counts.width(), counts.height());
    std::vector<float> background(static_cast<std::size_t>(counts.width()));
    for (int y = 0; y < counts.height(); ++y) {
        guess.background.row(y, counts.width(), background.data());
        for (int x = 0; x < counts.width(); ++x) {
            const float middle =
                (background[static_cast<std::size_t>(x)] + static_cast<float>(dark_level)) / 2;
            mask(x, y) = counts(x, y) < middle && visible(x, y) ? 1.0F : 0.0F;
        }
    }
    std::vector<FirstGuess> guesses;
    for (const CoarseSize& size : coarse_sizes(mask)) {
        guesses.push_back(guess);
        guesses.back().size = size;
    }
    // Where a diameter is given the levels are enough.
    if (guesses.empty()) guesses.push_back(guess);
    return guesses;
}

/// Whether all nine pixels about this one are looked at.
bool sees_around(const VisiblePixels& visible, int x, int y) {
    if (visible.are_all()) return true;
    for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) {
            if (!visible(u, v)) return false;
        }
    }
    return true;
}

}  // namespace

Levels levels_of(const Image& counts, const VisiblePixels& visible, int sparsely) {
    const int row_step = 4 * sparsely;
    const int column_step = 3 * sparsely;
    std::vector<float> sample;
    double sum = 0;
    double n = 0;
    float darkest = std::numeric_limits<float>::max();
    float brightest = std::numeric_limits<float>::lowest();
    for (int y = 1; y + 1 < counts.height(); y += row_step) {
        const float* a = counts.row(y - 1);
        const float* b = counts.row(y);
        const float* c = counts.row(y + 1);
        for (int x = 1; x + 1 < counts.width(); x += column_step) {
            if (!sees_around(visible, x, y)) continue;
            sample.push_back(b[x]);
            const float mean = (a[x - 1] + a[x] + a[x + 1] + b[x - 1] + b[x] + b[x + 1] + c[x - 1] +
                                c[x] + c[x + 1]) /
                               9;
            darkest = std::min(darkest, mean);
            brightest = std::max(brightest, mean);
            // Second differences along both axes cancel smooth structure; for white noise their RMS
            // is 6 σ.
            const float d = a[x - 1] - 2 * a[x] + a[x + 1] - 2 * (b[x - 1] - 2 * b[x] + b[x + 1]) +
                            c[x - 1] - 2 * c[x] + c[x + 1];
            sum += static_cast<double>(d) * static_cast<double>(d);
            n += 1;
        }
    }
    if (sample.empty()) return {0, 0, 0};
    const auto quantile = [&](double q) {
        const auto rank = static_cast<std::ptrdiff_t>(q * static_cast<double>(sample.size() - 1));
        std::nth_element(sample.begin(), sample.begin() + rank, sample.end());
        return static_cast<double>(sample[static_cast<std::size_t>(rank)]);
    };
    const double noise = std::sqrt(sum / n) / 6;
    const double low = quantile(0.005);
    const double high = quantile(0.995);
    // A few spheres cover less than the quantiles see. Means of nine pixels scatter by σ/3, those
    // of pure noise span 3 σ in a million.
    if (high - low < kBlank * noise) {
        return {std::min(low, static_cast<double>(darkest)),
                std::max(high, static_cast<double>(brightest)), noise};
    }
    return {low, high, noise};
}

std::string blank_reason(const Levels& levels) {
    const double contrast = levels.high - levels.low;
    if (!(contrast >= 2)) {
        return fmt::format(
            "no contrast: 99 % of the pixels lie between {:.0f} and {:.0f} counts "
            "(black, saturated or empty frame)",
            levels.low, levels.high);
    }
    // 99 % of white noise lies within ±2.6 σ: a contrast of 5.2 σ is what noise alone gives.
    if (contrast < kBlank * levels.noise) {
        return fmt::format("nothing above the noise: contrast {:.1f} counts, noise {:.1f} counts",
                           contrast, levels.noise);
    }
    return {};
}

Image turned_round(const Image& counts) {
    Image image = counts;
    for (float& v : image.pixels()) v = -v;
    return image;
}

std::vector<FirstGuess> first_guesses(const Image& counts, const Levels& levels,
                                      PolarityChoice polarity, double uniform_tolerance,
                                      const VisiblePixels& visible) {
    const double contrast = levels.high - levels.low;
    std::vector<FirstGuess> dark;
    std::vector<FirstGuess> bright;
    if (polarity != PolarityChoice::bright) {
        dark =
            guesses_for(counts, Polarity::dark, levels.low, contrast, uniform_tolerance, visible);
    }
    if (polarity != PolarityChoice::dark) {
        bright = guesses_for(turned_round(counts), Polarity::bright, -levels.high, contrast,
                             uniform_tolerance, visible);
    }
    if (!dark.empty() && !bright.empty() && dark[0].size.coverage < bright[0].size.coverage) {
        std::swap(dark, bright);
    }
    dark.insert(dark.end(), bright.begin(), bright.end());
    return dark;
}

}  // namespace grainfield::tracking
