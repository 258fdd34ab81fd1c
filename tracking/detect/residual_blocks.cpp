#include "tracking/detect/residual_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "core/support/parallel.h"

namespace grainfield::tracking {

double area_of(const std::vector<PixelBlock>& blocks) {
    double area = 0;
    for (const PixelBlock& b : blocks) area += static_cast<double>(b.x1 - b.x0) * (b.y1 - b.y0);
    return area;
}

ResidualBlocks::ResidualBlocks(const PaddedImage& darkness, const PaddedImage& transmission,
                               int block, int threads)
    : width_(darkness.width()),
      height_(darkness.height()),
      block_(std::max(1, block)),
      columns_((width_ + block_ - 1) / block_),
      rows_((height_ + block_ - 1) / block_),
      sums_(static_cast<std::size_t>(columns_ + 2) * static_cast<std::size_t>(rows_ + 2), 0.0) {
    const auto padded = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(block_);
    parallel_for(rows_, threads, [&](std::int64_t block_row) {
        const int row = static_cast<int>(block_row);
        std::vector<float> column(padded, 0.0F);
        float* sum = column.data();
        for (int y = row * block_; y < std::min(height_, (row + 1) * block_); ++y) {
            const float* d = darkness.row(y);
            const float* t = transmission.row(y);
#pragma omp simd
            for (int x = 0; x < width_; ++x) {
                const float r = d[x] - 1.0F + t[x];
                sum[x] += r * r;
            }
        }
        double* out = sums_.data() + static_cast<std::ptrdiff_t>(row + 1) * (columns_ + 2) + 1;
        for (int c = 0; c < columns_; ++c) {
            const auto first = column.begin() + static_cast<std::ptrdiff_t>(c) * block_;
            out[c] = static_cast<double>(std::accumulate(first, first + block_, 0.0F));
        }
    });
    total_ = std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

double ResidualBlocks::around(int column, int row) const {
    double sum = 0;
    for (int r = row; r < row + 3; ++r) {
        const double* first =
            sums_.data() + static_cast<std::ptrdiff_t>(r) * (columns_ + 2) + column;
        sum += first[0] + first[1] + first[2];
    }
    return sum;
}

int ResidualBlocks::column(Vec2 p) const {
    return std::clamp(static_cast<int>(std::lround(p.x)) / block_, 0, columns_ - 1);
}

int ResidualBlocks::row(Vec2 p) const {
    return std::clamp(static_cast<int>(std::lround(p.y)) / block_, 0, rows_ - 1);
}

double ResidualBlocks::rms(double pixels) const {
    return pixels > 0 ? std::sqrt(std::max(0.0, total_) / pixels) : 0;
}

void ResidualBlocks::subtract(Vec2 p, double gain) {
    const std::ptrdiff_t at =
        static_cast<std::ptrdiff_t>(row(p) + 1) * (columns_ + 2) + column(p) + 1;
    sums_[static_cast<std::size_t>(at)] -= gain;
    total_ -= gain;
}

ResidualBlocks::Usual ResidualBlocks::usual(const std::vector<Vec2>& discs) const {
    std::vector<double> sums;
    sums.reserve(discs.size());
    for (const Vec2 p : discs) sums.push_back(around(column(p), row(p)));
    if (sums.empty()) return {};
    const auto middle = sums.begin() + static_cast<std::ptrdiff_t>(sums.size() / 2);
    std::nth_element(sums.begin(), middle, sums.end());
    const double median = *middle;
    for (double& sum : sums) sum = std::abs(sum - median);
    std::nth_element(sums.begin(), middle, sums.end());
    return {median, 1.4826 * *middle};
}

std::vector<PixelBlock> ResidualBlocks::holding(double least) const {
    std::vector<PixelBlock> runs;
    for (int row = 0; row < rows_; ++row) {
        bool is_open = false;
        for (int column = 0; column < columns_; ++column) {
            const bool holds = around(column, row) >= least;
            const int end = std::min(width_, (column + 1) * block_);
            if (holds && is_open) {
                runs.back().x1 = end;
            } else if (holds) {
                runs.push_back(
                    {column * block_, row * block_, end, std::min(height_, (row + 1) * block_)});
            }
            is_open = holds;
        }
    }
    return runs;
}

ResidualBlocks residual_of(const JointFit& fit, const std::vector<double>& gain) {
    ResidualBlocks residual(fit.darkness(), fit.transmission(),
                            static_cast<int>(std::ceil(fit.disc().reach())), fit.threads());
    for (std::size_t j = 0; j < gain.size(); ++j) residual.subtract(fit.positions()[j], gain[j]);
    return residual;
}

double misfit_in(const JointFit& fit, Vec2 low, Vec2 high) {
    const PaddedImage& darkness = fit.darkness();
    const int x0 = std::max(0, static_cast<int>(std::ceil(low.x)));
    const int x1 = std::min(darkness.width(), static_cast<int>(std::floor(high.x)) + 1);
    const int y0 = std::max(0, static_cast<int>(std::ceil(low.y)));
    const int y1 = std::min(darkness.height(), static_cast<int>(std::floor(high.y)) + 1);
    double sum = 0;
    for (int y = y0; y < y1; ++y) {
        const float* d = darkness.row(y);
        const float* t = fit.transmission().row(y);
        float row = 0;
        for (int x = x0; x < x1; ++x) {
            const float r = d[x] - 1.0F + t[x];
            row += r * r;
        }
        sum += static_cast<double>(row);
    }
    return sum;
}

double misfit_about(const JointFit& fit, Vec2 place, double half) {
    return misfit_in(fit, place - Vec2{half, half}, place + Vec2{half, half});
}

std::vector<Vec2> ResidualBlocks::middles(const std::vector<PixelBlock>& runs) const {
    std::vector<Vec2> middles;
    for (const PixelBlock& run : runs) {
        for (int x = run.x0; x < run.x1; x += block_) {
            middles.push_back({x + 0.5 * (block_ - 1), run.y0 + 0.5 * (block_ - 1)});
        }
    }
    return middles;
}

}  // namespace grainfield::tracking
