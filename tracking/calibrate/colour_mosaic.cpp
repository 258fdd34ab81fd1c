#include "tracking/calibrate/colour_mosaic.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace grainfield::tracking {
namespace {

constexpr double kLeastStrength = 0.01;
constexpr double kLeastShare = 0.8;
constexpr double kFewestCells = 400;

/// One way in which the pixels of a cell may differ.
struct Contrast {
    double sum = 0, up = 0, down = 0;

    void add(double difference) {
        sum += difference;
        up += difference > 0 ? 1 : 0;
        down += difference < 0 ? 1 : 0;
    }
};

}  // namespace

ColourMosaic colour_mosaic(const Image& counts, double low, double high,
                           const VisiblePixels& visible) {
    const double middle = 0.5 * (low + high);
    std::array<Contrast, 3> contrasts;  // diagonals, columns, rows
    double cells = 0;
    double level = 0;
    for (int y = 0; y + 1 < counts.height(); y += 2) {
        for (int x = 0; x + 1 < counts.width(); x += 2) {
            if (!visible(x, y) || !visible(x + 1, y) || !visible(x, y + 1) ||
                !visible(x + 1, y + 1)) {
                continue;
            }
            const auto a = static_cast<double>(counts(x, y));
            const auto b = static_cast<double>(counts(x + 1, y));
            const auto c = static_cast<double>(counts(x, y + 1));
            const auto d = static_cast<double>(counts(x + 1, y + 1));
            const double mean = (a + b + c + d) / 4;
            if (mean < middle) continue;
            cells += 1;
            level += mean - std::min(low, 0.0);
            contrasts[0].add((a + d - b - c) / 2);
            contrasts[1].add((a + c - b - d) / 2);
            contrasts[2].add((a + b - c - d) / 2);
        }
    }
    ColourMosaic mosaic;
    if (cells < kFewestCells || !(level > 0)) return mosaic;
    const auto strength = [&](const Contrast& c) { return std::abs(c.sum) / level; };
    const auto share = [&](const Contrast& c) { return std::max(c.up, c.down) / cells; };
    const auto is_clear = [&](const Contrast& c) {
        return strength(c) > kLeastStrength && share(c) > kLeastShare;
    };
    // Sensors read by two or four amplifiers differ between columns or between rows only.
    const bool both = is_clear(contrasts[1]) && is_clear(contrasts[2]);
    mosaic.is_there = is_clear(contrasts[0]) || both;
    const Contrast& shown = both && !is_clear(contrasts[0])
                                ? std::max(contrasts[1], contrasts[2],
                                           [&](const Contrast& p, const Contrast& q) {
                                               return strength(p) < strength(q);
                                           })
                                : contrasts[0];
    mosaic.strength = strength(shown);
    mosaic.share = share(shown);
    return mosaic;
}

}  // namespace grainfield::tracking
