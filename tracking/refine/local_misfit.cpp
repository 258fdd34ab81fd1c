#include "tracking/refine/local_misfit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr int kBand = 32;  // rows
constexpr int kRows = 4;   // summed side by side: one sum alone waits for its own last term

/// Running sums along kRows rows, from row `first` on: entry x is the sum over the pixels before x.
class RowSums {
 public:
    explicit RowSums(int width) {
        for (auto& row : rows_) row.assign(static_cast<std::size_t>(width) + 1, 0.0);
    }

    /// Of what value(x, row) returns.
    template <class Value>
    void fill(int width, Value&& value) {
        std::array<double, kRows> sum{};
        for (int x = 0; x < width; ++x) {
            for (int k = 0; k < kRows; ++k) {
                const auto row = static_cast<std::size_t>(k);
                sum[row] += static_cast<double>(value(x, k));
                rows_[row][static_cast<std::size_t>(x) + 1] = sum[row];
            }
        }
    }

    /// Over [begin, end) of a row.
    double over(int row, int begin, int end) const {
        const std::vector<double>& sums = rows_[static_cast<std::size_t>(row)];
        return sums[static_cast<std::size_t>(end)] - sums[static_cast<std::size_t>(begin)];
    }

 private:
    std::array<std::vector<double>, kRows> rows_;
};

struct Band {
    std::vector<std::uint32_t> members;
    std::vector<LocalMisfit> misfits;  ///< what its rows add to each member
};

void sum_up(const PaddedImage& darkness, const PaddedImage& transmission,
            const VisiblePixels& visible, const std::vector<Vec2>& places, double reach,
            int first_row, Band& band) {
    const int width = darkness.width();
    const int end_row = std::min(darkness.height(), first_row + kBand);
    RowSums squares(width);
    RowSums seen(visible.are_all() ? 0 : width);
    band.misfits.resize(band.members.size());
    for (int top = first_row; top < end_row; top += kRows) {
        // Rows below the last one are the margin's: no residual there.
        std::array<const float*, kRows> d{};
        std::array<const float*, kRows> t{};
        for (int k = 0; k < kRows; ++k) {
            d[static_cast<std::size_t>(k)] = darkness.row(std::min(top + k, end_row - 1));
            t[static_cast<std::size_t>(k)] = transmission.row(std::min(top + k, end_row - 1));
        }
        squares.fill(width, [&](int x, int k) {
            const auto row = static_cast<std::size_t>(k);
            const float r = d[row][x] - 1.0F + t[row][x];
            return r * r;
        });
        if (!visible.are_all()) {
            seen.fill(width, [&](int x, int k) {
                return visible(x, std::min(top + k, end_row - 1)) ? 1.0F : 0.0F;
            });
        }
        for (std::size_t m = 0; m < band.members.size(); ++m) {
            const Vec2 p = places[band.members[m]];
            for (int k = 0; k < std::min(kRows, end_row - top); ++k) {
                const double dy = top + k - p.y;
                const double square = reach * reach - dy * dy;
                if (square < 0) continue;
                const double half = std::sqrt(square);
                const int begin = std::max(0, static_cast<int>(std::ceil(p.x - half)));
                const int end = std::min(width, static_cast<int>(std::floor(p.x + half)) + 1);
                if (end <= begin) continue;
                band.misfits[m].sum += squares.over(k, begin, end);
                band.misfits[m].pixels +=
                    visible.are_all() ? end - begin : seen.over(k, begin, end);
            }
        }
    }
}

}  // namespace

std::vector<LocalMisfit> local_misfits(const PaddedImage& darkness, const PaddedImage& transmission,
                                       const VisiblePixels& visible,
                                       const std::vector<Vec2>& places, double reach, int threads) {
    const int n = (darkness.height() + kBand - 1) / kBand;
    std::vector<Band> bands(static_cast<std::size_t>(n));
    for (std::uint32_t j = 0; j < places.size(); ++j) {
        const double y = places[j].y;
        const int low = static_cast<int>(std::floor((y - reach) / kBand));
        const int high = static_cast<int>(std::floor((y + reach) / kBand));
        for (int b = std::max(0, low); b <= std::min(n - 1, high); ++b) {
            bands[static_cast<std::size_t>(b)].members.push_back(j);
        }
    }
    parallel_for(n, threads, [&](std::int64_t b) {
        sum_up(darkness, transmission, visible, places, reach, static_cast<int>(b) * kBand,
               bands[static_cast<std::size_t>(b)]);
    });
    std::vector<LocalMisfit> misfits(places.size());
    for (const Band& band : bands) {
        for (std::size_t m = 0; m < band.members.size(); ++m) {
            misfits[band.members[m]].sum += band.misfits[m].sum;
            misfits[band.members[m]].pixels += band.misfits[m].pixels;
        }
    }
    return misfits;
}

}  // namespace grainfield::tracking
