#include "tracking/calibrate/learned_profile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include <Eigen/Dense>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

constexpr double kSpacing = 0.25;  // [w]
constexpr int kMostIntervals = 400;
constexpr double kEdge = 2;          // [w] from the edge: where a correction moves positions
constexpr double kInfluence = 2.3;   // [w] from the edge: P = 0.01
constexpr double kSignificance = 2;  // [σ]
constexpr std::int64_t kMostPixels = 200'000;

/// Σ share · unknown = residual, one for each pixel. The unknowns are C at r = 0, spacing, … but
/// for the reach, where it is zero, and last the veil.
struct Equations {
    struct Term {
        int unknown;
        float share;
    };
    int knots;
    double spacing;  ///< [px]
    std::vector<Term> terms;
    std::vector<std::size_t> end;  ///< of the terms of each pixel
    std::vector<float> residual;

    explicit Equations(const DiscProfile& disc) {
        const double wanted = disc.reach() / (kSpacing * disc.edge_width);
        knots = static_cast<int>(std::clamp(std::ceil(wanted), 2.0, 1.0 * kMostIntervals));
        spacing = disc.reach() / knots;
    }
    /// `distances` of the discs that reach the pixel.
    void add(double value, const std::vector<double>& distances, const DiscProfile& disc) {
        double passed = 1;
        for (const double r : distances) passed *= 1 - disc.darkness(r);
        for (const double r : distances) {
            // The core of a disc alone: nothing else dims it.
            const double own = 1 - disc.darkness(r);
            const double others = distances.size() == 1 ? 1 : passed / std::max(own, 1e-12);
            const double place = r / spacing;
            const int below = std::min(static_cast<int>(place), knots - 1);
            const double upper = place - below;
            terms.push_back({below, static_cast<float>(others * (1 - upper))});
            if (below + 1 < knots) {
                terms.push_back({below + 1, static_cast<float>(others * upper)});
            }
        }
        terms.push_back({knots, static_cast<float>(passed)});
        end.push_back(terms.size());
        residual.push_back(static_cast<float>(value));
    }
    /// Calls action(terms, residual) for each pixel.
    template <class Action>
    void each(Action&& action) const {
        std::size_t begin = 0;
        for (std::size_t i = 0; i < end.size(); ++i) {
            action(std::span(terms).subspan(begin, end[i] - begin),
                   static_cast<double>(residual[i]));
            begin = end[i];
        }
    }
};

/// Every few pixels of the frame that are near one disc at most.
Equations exposed_equations(const Image& residual, const std::vector<Vec2>& positions,
                            const DiscProfile& disc, const VisiblePixels& visible,
                            LearnedProfile& learned) {
    Equations equations(disc);
    PointGrid grid(residual.width(), residual.height(), disc.reach());
    for (std::size_t j = 0; j < positions.size(); ++j) {
        grid.add(positions[j], static_cast<std::uint32_t>(j));
    }
    const auto pixels = static_cast<std::int64_t>(residual.size());
    const auto stride = static_cast<int>(1 + pixels / kMostPixels);
    const double influence = disc.radius() + kInfluence * disc.edge_width;
    std::vector<double> distances;
    for (int y = 0; y < residual.height(); ++y) {
        // No column is left out in all rows.
        for (int x = 3 * y % stride; x < residual.width(); x += stride) {
            if (!visible(x, y)) continue;
            const Vec2 pixel{static_cast<double>(x), static_cast<double>(y)};
            distances.clear();
            int near = 0;
            grid.near(pixel, disc.reach(), [&](std::uint32_t, Vec2 p) {
                distances.push_back(norm(p - pixel));
                near += distances.back() < influence ? 1 : 0;
            });
            if (near > 1) continue;
            learned.pixels += distances.empty() ? 0 : 1;
            equations.add(static_cast<double>(residual(x, y)), distances, disc);
        }
    }
    return equations;
}

}  // namespace

LearnedProfile learn_profile(const Image& residual, const std::vector<Vec2>& positions,
                             const DiscProfile& disc, const VisiblePixels& visible) {
    LearnedProfile learned;
    const Equations equations = exposed_equations(residual, positions, disc, visible, learned);
    const int knots = equations.knots;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(knots + 1, knots + 1);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(knots + 1);
    Eigen::VectorXd pixels = Eigen::VectorXd::Zero(knots + 1);
    equations.each([&](auto terms, double value) {
        for (const auto& term : terms) {
            const auto share = static_cast<double>(term.share);
            for (const auto& other : terms) {
                a(term.unknown, other.unknown) += share * static_cast<double>(other.share);
            }
            b(term.unknown) += share * value;
            pixels(term.unknown) += share;
        }
    });
    const auto is_at_edge = [&](int knot) {
        return std::abs(knot * equations.spacing - disc.radius()) < kEdge * disc.edge_width;
    };
    learned.fewest = static_cast<double>(learned.pixels);
    for (int k = 0; k < knots; ++k) {
        if (is_at_edge(k)) learned.fewest = std::min(learned.fewest, pixels(k));
    }
    if (!learned.is_sampled()) return learned;

    a.diagonal().array() += 1e-6;  // the middle of few discs may hold no pixel
    const Eigen::MatrixXd inverse = a.llt().solve(Eigen::MatrixXd::Identity(knots + 1, knots + 1));
    const Eigen::VectorXd c = inverse * b;
    Eigen::VectorXd scatter = Eigen::VectorXd::Zero(knots + 1);
    equations.each([&](auto terms, double left) {
        learned.rms += left * left;
        for (const auto& term : terms) left -= static_cast<double>(term.share) * c(term.unknown);
        learned.rms_left += left * left;
        for (const auto& term : terms) {
            scatter(term.unknown) += static_cast<double>(term.share) * left * left;
        }
    });
    learned.rms = std::sqrt(learned.rms / static_cast<double>(equations.end.size()));
    learned.rms_left = std::sqrt(learned.rms_left / static_cast<double>(equations.end.size()));
    learned.veil = c(knots);
    std::vector<float> value(static_cast<std::size_t>(knots) + 1, 0.0F);
    bool is_significant = false;
    for (int k = 0; k < knots; ++k) {
        if (pixels(k) <= 0) continue;
        const double variance = inverse(k, k) * scatter(k) / pixels(k);
        if (is_at_edge(k)) learned.error = std::max(learned.error, std::sqrt(variance));
        const double noise = kSignificance * kSignificance * variance;
        if (c(k) * c(k) <= noise) continue;
        value[static_cast<std::size_t>(k)] =
            static_cast<float>((c(k) - noise / c(k)) / (1 - learned.veil));
        is_significant = true;
    }
    if (is_significant) learned.correction = {equations.spacing, std::move(value)};
    return learned;
}

}  // namespace grainfield::tracking
