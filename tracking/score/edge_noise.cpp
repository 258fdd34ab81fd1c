#include "tracking/score/edge_noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace grainfield::tracking {

namespace {

constexpr std::size_t kFewest = 50;

/// Per pixel 0: on an edge, 1: between the spheres, 2: in the core of one.
std::vector<std::uint8_t> places(const Image& counts, const DiscProfile& disc,
                                 const std::vector<Vec2>& truth, double widths) {
    std::vector<std::uint8_t> place(counts.size(), 1);
    const double core = disc.radius() - widths * disc.edge_width;
    const double reach = disc.radius() + widths * disc.edge_width;
    for (const Vec2 c : truth) {
        const int first_row = static_cast<int>(std::max(0.0, std::ceil(c.y - reach)));
        const double last_row = std::min(counts.height() - 1.0, c.y + reach);
        const int first = static_cast<int>(std::max(0.0, std::ceil(c.x - reach)));
        const double last = std::min(counts.width() - 1.0, c.x + reach);
        for (int y = first_row; y <= last_row; ++y) {
            for (int x = first; x <= last; ++x) {
                const double r = std::hypot(x - c.x, y - c.y);
                if (r > reach) continue;
                std::uint8_t& p =
                    place[static_cast<std::size_t>(y) * static_cast<std::size_t>(counts.width()) +
                          static_cast<std::size_t>(x)];
                if (r < core) {
                    p = 2;
                } else if (p == 1) {
                    p = 0;
                }
            }
        }
    }
    return place;
}

/// Variance of a pixel from second differences; negative if there are too few. Changes its input.
double variance_of(std::vector<float>& differences) {
    if (differences.size() < kFewest) return -1;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::vector<float> size = differences;
    for (float& d : size) d = std::abs(d);
    std::nth_element(size.begin(), size.begin() + (middle - differences.begin()), size.end());
    // Coarse counts have a median of zero: then nothing is an outlier.
    const double robust = 1.4826 * static_cast<double>(size[size.size() / 2]);
    double squares = 0;
    double count = 0;
    for (const float d : differences) {
        if (robust > 0 && std::abs(static_cast<double>(d)) > 6 * robust) continue;
        squares += static_cast<double>(d) * static_cast<double>(d);
        ++count;
    }
    return squares / count / 6;  // 1² + 2² + 1²
}

/// Second differences along the rows, between the spheres and in their cores.
struct Differences {
    std::vector<float> bright, dark;
};

Differences differences_of(const Image& counts, const std::vector<std::uint8_t>& place) {
    Differences all;
    for (int y = 0; y < counts.height(); ++y) {
        const float* row = counts.row(y);
        const std::uint8_t* p =
            place.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(counts.width());
        for (int x = 1; x + 1 < counts.width(); ++x) {
            if (p[x] == 0 || p[x - 1] != p[x] || p[x + 1] != p[x]) continue;
            (p[x] == 1 ? all.bright : all.dark).push_back(row[x - 1] - 2 * row[x] + row[x + 1]);
        }
    }
    return all;
}

double mean_contrast(const ImageModel& model, int width, int height) {
    constexpr int kSamples = 16;
    double sum = 0;
    for (int row = 0; row < kSamples; ++row) {
        for (int column = 0; column < kSamples; ++column) {
            sum += model.background((column + 0.5) * width / kSamples,
                                    (row + 0.5) * height / kSamples) -
                   model.dark_level;
        }
    }
    return std::abs(sum) / (kSamples * kSamples);
}

}  // namespace

double edge_noise(const Image& counts, const ImageModel& model, const std::vector<Vec2>& truth) {
    const double contrast = mean_contrast(model, counts.width(), counts.height());
    if (!(contrast > 0)) return 0;
    // Small or crowded spheres leave no pixel far from all edges; then nearer ones have to do.
    for (const double widths : {4.5, 3.5, 2.5}) {
        Differences all = differences_of(counts, places(counts, model.disc, truth, widths));
        const bool is_last = widths < 3;
        if (!is_last && std::min(all.bright.size(), all.dark.size()) < kFewest) continue;
        double light = variance_of(all.bright);
        double shade = variance_of(all.dark);
        if (light <= 0) light = shade;
        if (shade < 0) shade = light;
        return light > 0 ? std::sqrt((light + shade) / 2) / contrast : 0;
    }
    return 0;
}

}  // namespace grainfield::tracking
