#include "tracking/calibrate/background.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace grainfield::tracking {
namespace {

constexpr int kTilesPerSide = 14;
constexpr int kEnvelopeDegree = 3;
constexpr int kClearDegree = 5;
constexpr double kClearTransmission = 0.9;
/// Tiles of which less is visible say nothing.
constexpr double kLeastOfTile = 0.25;

struct Tile {
    int x0, y0, x1, y1;
};

std::vector<Tile> tiles_of(int width, int height, int per_side) {
    std::vector<Tile> tiles;
    for (int iy = 0; iy < per_side; ++iy) {
        for (int ix = 0; ix < per_side; ++ix) {
            const Tile t{width * ix / per_side, height * iy / per_side, width * (ix + 1) / per_side,
                         height * (iy + 1) / per_side};
            if (t.x1 > t.x0 && t.y1 > t.y0) tiles.push_back(t);
        }
    }
    return tiles;
}

float percentile(std::vector<float>& values, double fraction) {
    const auto n = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + n, values.end());
    return values[static_cast<std::size_t>(n)];
}

BackgroundSurface uniform_if_flat(const BackgroundSurface& surface, int width, int height,
                                  double tolerance) {
    double low = surface(0, 0);
    double high = low;
    double sum = 0;
    int count = 0;
    for (int iy = 0; iy <= 16; ++iy) {
        for (int ix = 0; ix <= 16; ++ix) {
            const double b = surface((width - 1) * ix / 16.0, (height - 1) * iy / 16.0);
            low = std::min(low, b);
            high = std::max(high, b);
            sum += b;
            ++count;
        }
    }
    const double mean = sum / count;
    return high - low <= tolerance ? BackgroundSurface(mean) : surface;
}

/// (fall of the misfit per term) / (misfit of the surface per degree of freedom).
double f_ratio(const BackgroundSurface& surface, const BackgroundSurface& level,
               const std::vector<BackgroundSurface::Sample>& samples) {
    double with = 0;
    double without = 0;
    for (const auto& s : samples) {
        with += s.weight * std::pow(s.value - surface(s.x, s.y), 2);
        without += s.weight * std::pow(s.value - level(s.x, s.y), 2);
    }
    const int terms = surface.terms() - 1;
    const double freedom = static_cast<double>(samples.size()) - surface.terms();
    if (terms <= 0 || freedom <= 0) return 0;
    return (without - with) / terms / (with / freedom + 1e-12);
}

}  // namespace

BackgroundSurface upper_envelope(const Image& counts, double contrast, double uniform_tolerance,
                                 const VisiblePixels& visible) {
    std::vector<BackgroundSurface::Sample> samples;
    std::vector<float> values;
    for (const Tile& t : tiles_of(counts.width(), counts.height(), kTilesPerSide)) {
        values.clear();
        for (int y = t.y0; y < t.y1; ++y) {
            for (int x = t.x0; x < t.x1; ++x) {
                if (visible(x, y)) values.push_back(counts(x, y));
            }
        }
        const double all = static_cast<double>(t.x1 - t.x0) * (t.y1 - t.y0);
        if (static_cast<double>(values.size()) < kLeastOfTile * all) continue;
        samples.push_back({(t.x0 + t.x1 - 1) / 2.0, (t.y0 + t.y1 - 1) / 2.0,
                           static_cast<double>(percentile(values, 0.98)), 1.0});
    }
    BackgroundSurface surface =
        BackgroundSurface::fit(counts.width(), counts.height(), kEnvelopeDegree, samples);
    for (int iteration = 0; iteration < 20; ++iteration) {
        for (auto& s : samples) {
            // Tiles below the surface by more than 2 % of the contrast hold no clear pixel.
            const double below = (surface(s.x, s.y) - s.value) / (0.02 * contrast + 1e-12);
            s.weight = below <= 0 ? 1.0 : 1 / (1 + below * below);
        }
        surface = BackgroundSurface::fit(counts.width(), counts.height(), kEnvelopeDegree, samples);
    }
    return uniform_if_flat(surface, counts.width(), counts.height(), uniform_tolerance * contrast);
}

BackgroundSurface background_between_spheres(const Image& counts, const PaddedImage& transmission,
                                             double dark_level, const BackgroundSurface& previous,
                                             double contrast, double uniform_tolerance) {
    std::vector<BackgroundSurface::Sample> samples;
    const int tiles_per_side = std::clamp(std::min(counts.width(), counts.height()) / 24, 8, 48);
    for (const Tile& tile : tiles_of(counts.width(), counts.height(), tiles_per_side)) {
        BackgroundSurface::Sample sample{0, 0, 0, 0};
        for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1; ++x) {
                const auto t = static_cast<double>(transmission(x, y));
                if (t < kClearTransmission) continue;
                sample.x += t * t * x;
                sample.y += t * t * y;
                sample.value += t * (static_cast<double>(counts(x, y)) - dark_level * (1 - t));
                sample.weight += t * t;
            }
        }
        if (sample.weight < 8) continue;
        sample.x /= sample.weight;
        sample.y /= sample.weight;
        sample.value /= sample.weight;
        samples.push_back(sample);
    }
    if (samples.size() < 3 * static_cast<std::size_t>(BackgroundSurface::terms_of(1)))
        return previous;
    auto surface = BackgroundSurface::fit(counts.width(), counts.height(), kClearDegree, samples);
    auto level = BackgroundSurface::fit(counts.width(), counts.height(), 0, samples);
    if (f_ratio(surface, level, samples) < 3) return level;
    return uniform_if_flat(surface, counts.width(), counts.height(), uniform_tolerance * contrast);
}

}  // namespace grainfield::tracking
