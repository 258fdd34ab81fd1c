#include "tracking/calibrate/film_background.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "core/support/parallel.h"
#include "tracking/detect/distance_transform.h"
#include "tracking/model/background_surface.h"

namespace grainfield::tracking {
namespace {

constexpr double kHigh = 0.95;        // quantile
constexpr double kNeverClear = 0.15;  // [contrast]
constexpr float kSameLevel = 3;       // [noise]
constexpr double kLeastNoise = 0.3;   // [counts] of rounding
constexpr double kSmooth = 0.01;      // [contrast]
constexpr double kSurely = 4;         // [standard errors]
constexpr int kDegree = 5;
constexpr int kTilesPerSide = 12;
constexpr int kSmallestTile = 8;   // [px]
constexpr int kLargestTile = 32;   // [px]
constexpr double kOutlier = 0.02;  // [contrast]
constexpr int kIterations = 10;

struct Level {
    float light;
    float error;
};

/// Of the light above the core; `values` are reordered.
Level clear_level(std::vector<float>& values, float least, float noise) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const auto n = values.size();
    const auto rank = static_cast<std::ptrdiff_t>(kHigh * static_cast<double>(n - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    const float high = values[static_cast<std::size_t>(rank)];
    if (!(high > least)) return {nan, nan};
    const auto clear =
        std::partition(values.begin(), values.end(), [&](float v) { return v > high / 2; });
    const auto middle = values.begin() + (clear - values.begin()) / 2;
    std::nth_element(values.begin(), middle, clear);
    const float median = *middle;
    float sum = 0;
    float count = 0;
    for (auto v = values.begin(); v != clear; ++v) {
        if (std::abs(*v - median) > kSameLevel * noise) continue;
        sum += *v;
        count += 1;
    }
    return {sum / count, noise / std::sqrt(count)};
}

/// Through the medians of tiles; those far from the surface lose their weight. Nothing if no tile
/// is half known.
std::optional<BackgroundSurface> smooth_surface(const Image& level, const VisiblePixels& visible,
                                                double contrast) {
    const int side = std::clamp(std::min(level.width(), level.height()) / kTilesPerSide,
                                kSmallestTile, kLargestTile);
    std::vector<BackgroundSurface::Sample> samples;
    std::vector<float> known;
    for (int y0 = 0; y0 < level.height(); y0 += side) {
        for (int x0 = 0; x0 < level.width(); x0 += side) {
            known.clear();
            for (int y = y0; y < std::min(level.height(), y0 + side); ++y) {
                for (int x = x0; x < std::min(level.width(), x0 + side); ++x) {
                    if (visible(x, y) && std::isfinite(level(x, y))) known.push_back(level(x, y));
                }
            }
            if (2 * known.size() < static_cast<std::size_t>(side) * static_cast<std::size_t>(side))
                continue;
            const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
            std::nth_element(known.begin(), middle, known.end());
            samples.push_back({std::min<double>(x0 + side / 2.0, level.width()) - 0.5,
                               std::min<double>(y0 + side / 2.0, level.height()) - 0.5,
                               static_cast<double>(*middle), 1});
        }
    }
    if (samples.empty()) return std::nullopt;
    BackgroundSurface surface;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        surface = BackgroundSurface::fit(level.width(), level.height(), kDegree, samples);
        for (auto& sample : samples) {
            const double off = (sample.value - surface(sample.x, sample.y)) / (kOutlier * contrast);
            sample.weight = 1 / (1 + off * off);
        }
    }
    return surface;
}

}  // namespace

FilmLevels FilmLevels::of(const ImageModel& model, int width, int height) {
    const double clear = model.background(width / 2.0, height / 2.0);
    FilmLevels levels;
    levels.sign = model.polarity == Polarity::dark ? 1 : -1;
    levels.core = model.dark_level;
    levels.contrast = std::abs(clear - model.dark_level);
    levels.noise = model.noise * levels.contrast;
    levels.reach = model.disc.shape->reach_in_widths() * model.disc.edge_width;
    return levels;
}

void ClearLevelEstimator::add(const Image& counts) {
    std::vector<std::uint16_t> sample(counts.size());
    std::transform(counts.pixels().begin(), counts.pixels().end(), sample.begin(), [](float v) {
        return static_cast<std::uint16_t>(std::lround(std::clamp(v, 0.0F, 65535.0F)));
    });
    samples_.push_back(std::move(sample));
}

ClearLevels ClearLevelEstimator::estimate(const FilmLevels& levels, int threads) const {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    ClearLevels clear{Image(width_, height_, nan), Image(width_, height_, nan)};
    if (samples_.empty()) return clear;
    const auto sign = static_cast<float>(levels.sign);
    const auto core = static_cast<float>(levels.core);
    const auto least = static_cast<float>(kNeverClear * levels.contrast);
    const auto noise = static_cast<float>(std::max(levels.noise, kLeastNoise));
    parallel_for(height_, threads, [&](std::int64_t row) {
        std::vector<float> values(samples_.size());
        const auto y = static_cast<int>(row);
        for (int x = 0; x < width_; ++x) {
            const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x);
            for (std::size_t k = 0; k < samples_.size(); ++k) {
                values[k] = sign * (static_cast<float>(samples_[k][at]) - core);
            }
            const Level level = clear_level(values, least, noise);
            clear.level(x, y) = core + sign * level.light;
            clear.error(x, y) = level.error;
        }
    });
    return clear;
}

Evening evening_of(const ClearLevels& clear, const FilmLevels& levels,
                   const VisiblePixels& visible) {
    const int width = clear.level.width();
    const int height = clear.level.height();
    Evening evening{.gain = Image(width, height, 1)};
    const auto seen =
        static_cast<double>(visible.count(static_cast<std::int64_t>(clear.level.size())));
    Image known(width, height, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (std::isfinite(clear.level(x, y))) continue;
            known(x, y) = 0;
            if (visible(x, y)) evening.never_clear += 1 / seen;
        }
    }
    const auto surface = smooth_surface(clear.level, visible, levels.contrast);
    if (!surface) return evening;
    const Image distance = squared_distance_transform(known);
    const auto reach = static_cast<float>(levels.reach * levels.reach);
    std::vector<float> smooth(static_cast<std::size_t>(width));
    for (int y = 0; y < height; ++y) {
        surface->row(y, width, smooth.data());
        for (int x = 0; x < width; ++x) {
            if (!visible(x, y) || !(distance(x, y) > reach)) continue;
            const auto level = static_cast<double>(clear.level(x, y));
            const auto even = static_cast<double>(smooth[static_cast<std::size_t>(x)]);
            const double difference = std::abs(level - even);
            if (difference < std::max(kSmooth * levels.contrast,
                                      kSurely * static_cast<double>(clear.error(x, y)))) {
                continue;
            }
            evening.gain(x, y) = static_cast<float>((even - levels.core) / (level - levels.core));
            evening.uneven += 1 / seen;
            evening.strongest = std::max(evening.strongest, difference / levels.contrast);
        }
    }
    return evening;
}

void even_out(Image& counts, const Image& gain, const FilmLevels& levels, int threads) {
    const auto core = static_cast<float>(levels.core);
    parallel_for(counts.height(), threads, [&](std::int64_t row) {
        const auto y = static_cast<int>(row);
        for (int x = 0; x < counts.width(); ++x) {
            const float g = gain(x, y);
            if (g != 1) counts(x, y) = core + g * (counts(x, y) - core);
        }
    });
}

}  // namespace grainfield::tracking
