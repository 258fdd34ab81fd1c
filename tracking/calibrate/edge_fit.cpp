#include "tracking/calibrate/edge_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace grainfield::tracking {
namespace {

constexpr float kNobodys = 1000;    ///< owners of a pixel that is not visible
constexpr double kBinWidth = 0.02;  ///< [px], far below any edge width

}  // namespace

std::vector<RadialBin> exposed_profile(const Image& darkness, const std::vector<Vec2>& positions,
                                       const DiscProfile& disc, const VisiblePixels& visible) {
    const double influence = disc.radius() + 2.3 * disc.edge_width;
    Image owners(darkness.width(), darkness.height());
    const auto visit = [&](Vec2 c, double reach, auto&& action) {
        const int y1 = std::min(darkness.height() - 1, static_cast<int>(c.y + reach));
        const int x1 = std::min(darkness.width() - 1, static_cast<int>(c.x + reach));
        for (int y = std::max(0, static_cast<int>(std::ceil(c.y - reach))); y <= y1; ++y) {
            for (int x = std::max(0, static_cast<int>(std::ceil(c.x - reach))); x <= x1; ++x) {
                const double squared = squared_norm(Vec2{x - c.x, y - c.y});
                if (squared < reach * reach) action(x, y, squared);
            }
        }
    };
    if (!visible.are_all()) {
        for (int y = 0; y < owners.height(); ++y) {
            for (int x = 0; x < owners.width(); ++x) {
                if (!visible(x, y)) owners(x, y) = kNobodys;
            }
        }
    }
    for (const Vec2 c : positions) {
        visit(c, influence, [&](int x, int y, double) { owners(x, y) += 1; });
    }
    std::vector<RadialBin> bins(static_cast<std::size_t>(disc.reach() / kBinWidth) + 1);
    for (const Vec2 c : positions) {
        visit(c, disc.reach(), [&](int x, int y, double squared) {
            const float others = owners(x, y) - (squared < influence * influence ? 1.0F : 0.0F);
            if (others != 0) return;
            const double r = std::sqrt(squared);
            RadialBin& bin = bins[static_cast<std::size_t>(r / kBinWidth)];
            const auto value = static_cast<double>(darkness(x, y));
            bin.r += r;
            bin.darkness += value;
            bin.squares += value * value;
            bin.count += 1;
        });
    }
    std::erase_if(bins, [](const RadialBin& bin) { return bin.count == 0; });
    for (RadialBin& bin : bins) {
        bin.r /= bin.count;
        bin.darkness /= bin.count;
    }
    return bins;
}

double rough_edge_width(const Image& darkness, const VisiblePixels& visible) {
    double between = 0;
    double crossings = 0;
    for (int y = 0; y + 1 < darkness.height(); ++y) {
        const float* row = darkness.row(y);
        const float* below = darkness.row(y + 1);
        for (int x = 0; x + 1 < darkness.width(); ++x) {
            if (!visible(x, y) || !visible(x + 1, y) || !visible(x, y + 1)) continue;
            const bool inside = row[x] > 0.5F;
            between += row[x] > 0.25F && row[x] < 0.75F ? 1 : 0;
            crossings += inside != (row[x + 1] > 0.5F) ? 1 : 0;
            crossings += inside != (below[x] > 0.5F) ? 1 : 0;
        }
    }
    const double length = std::numbers::pi / 4 * crossings;
    return length > 0 ? between / length / (2 * std::atanh(0.5)) : 0;
}

EdgeFit fit_exposed_edges(const Image& darkness, const std::vector<Vec2>& positions,
                          const DiscProfile& start, const VisiblePixels& visible) {
    EdgeFit fit;
    fit.disc = start;
    const std::vector<RadialBin> bins = exposed_profile(darkness, positions, start, visible);
    double count = 0;
    double scatter = 0;  // within bins: no fit can remove it
    for (const RadialBin& bin : bins) {
        count += bin.count;
        scatter += bin.squares - bin.count * bin.darkness * bin.darkness;
    }
    if (bins.size() < 30) return fit;
    double damping = 1e-3;
    double best = -1;
    DiscProfile disc = start;
    double amplitude = 1;
    double offset = 0;
    for (int iteration = 0; iteration < 40; ++iteration) {
        Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
        Eigen::Vector4d b = Eigen::Vector4d::Zero();
        double misfit = 0;
        for (const RadialBin& bin : bins) {
            const double r = bin.r;
            const double p = disc.darkness(r);
            const double residual = bin.darkness - offset - amplitude * p;
            const SizeDerivatives change = disc.size_derivatives(r, amplitude);
            const Eigen::Vector4d j(change.by_diameter, change.by_edge_width, p, 1);
            a += bin.count * j * j.transpose();
            b += bin.count * residual * j;
            misfit += bin.count * residual * residual;
        }
        if (best >= 0 && misfit > best * (1 + 1e-12)) {
            damping *= 10;
            disc = fit.disc;
            amplitude = fit.amplitude;
            offset = fit.offset;
            if (damping > 1e6) {
                fit.converged = true;  // no step improves it
                break;
            }
        } else {
            const bool settled = best >= 0 && best - misfit < 1e-9 * best;
            best = misfit;
            fit.disc = disc;
            fit.amplitude = amplitude;
            fit.offset = offset;
            damping *= 0.3;
            if (settled) {
                fit.converged = true;
                break;
            }
        }
        a.diagonal() *= 1 + damping;
        const Eigen::Vector4d d = a.ldlt().solve(b);
        if (!d.allFinite()) break;
        disc.diameter = std::clamp(disc.diameter + d(0), 0.5 * start.diameter, 2 * start.diameter);
        disc.edge_width =
            std::clamp(disc.edge_width + d(1), 0.2 * start.edge_width, 5 * start.edge_width);
        amplitude = std::clamp(amplitude + d(2), 0.2, 5.0);
        offset = std::clamp(offset + d(3), -0.5, 0.5);
    }
    fit.pixels = static_cast<std::int64_t>(count);
    fit.rms = std::sqrt((best + scatter) / count);
    return fit;
}

}  // namespace grainfield::tracking
