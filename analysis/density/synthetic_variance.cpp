#include "analysis/density/synthetic_variance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

using std::numbers::pi;

constexpr double far = 64 * pi;  // where A(q) becomes 8/q³; its oscillation cos(q) ends a period
constexpr double most_steps = 4000;

double squared_sinc(double x) {
    if (std::abs(x) < 1e-4) return 1 - x * x / 3;
    const double s = std::sin(x) / x;
    return s * s;
}

// Nodes and weights of the Gauss–Legendre rule of eight points on [−1, 1].
constexpr std::array<double, 4> gauss_node{0.1834346424956498, 0.5255324099163290,
                                           0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_weight{0.3626837833783620, 0.3137066458778873,
                                             0.2223810344533745, 0.1012285362903763};

template <class Function>
void integrate(double from, double to, Function&& f) {
    const double middle = 0.5 * (from + to);
    const double half = 0.5 * (to - from);
    for (std::size_t i = 0; i < gauss_node.size(); ++i) {
        f(middle - half * gauss_node[i], half * gauss_weight[i]);
        f(middle + half * gauss_node[i], half * gauss_weight[i]);
    }
}

// q A(q) for one window, added to the parameters that S has there; returns ∫ q A dq.
double add_range(const SpectrumModel& model, double window, double from, double to,
                 std::vector<double>& jacobian) {
    double total = 0;
    integrate(from, to, [&](double q, double weight) {
        const double power = weight * (q < far ? q * window_power(q) : 8 / (q * q));
        total += power;
        for (const SpectrumModel::Share& share : model.shares(q / window)) {
            if (share.weight != 0) jacobian[share.parameter] += share.weight * power;
        }
    });
    return total;
}

SyntheticVariance in_infinite_box(const SpectrumModel& model, double density, double window) {
    std::vector<double> jacobian(model.size(), 0.0);
    double covered = 0;  // ∫ q A dq up to k_max
    const std::vector<double>& corners = model.corners();
    for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
        double from = corners[c] * window;
        const double end = corners[c + 1] * window;
        while (from < end) {
            // Steps that follow A's oscillation, then its decay; they end on `far`.
            double to = from < far ? std::min(from + pi, far) : 1.5 * from;
            to = std::min(to, end);
            covered += add_range(model, window, from, to, jacobian);
            from = to;
        }
    }
    const double last = corners.back() * window;
    // S = tail beyond k_max. ∫ q A dq over all q is 2π.
    const double beyond = model.tail() * (last < far ? 2 * pi - covered : 8 / last);
    const double unit = density * window * window / (2 * pi);
    SyntheticVariance result{unit * beyond, 0, unit * beyond};
    for (std::size_t p = 0; p < jacobian.size(); ++p) {
        result.variance += unit * jacobian[p] * model.theta()[p];
    }
    result.error = unit * std::sqrt(model.variance(jacobian));
    return result;
}

// The wavevectors of one quadrant with |k| ≤ k_max, for the sum of a finite box.
struct QuadrantMode {
    std::size_t nx = 0, ny = 0;
    double count = 0;  // how many wavevectors have these |n_x|, |n_y|
    std::array<SpectrumModel::Share, 2> shares;
};

std::vector<QuadrantMode> quadrant(const SpectrumModel& model, double step, std::size_t most) {
    std::vector<QuadrantMode> modes;
    for (std::size_t nx = 0; nx <= most; ++nx) {
        for (std::size_t ny = 0; ny <= most; ++ny) {
            if (nx + ny == 0) continue;
            const double k = step * std::hypot(static_cast<double>(nx), static_cast<double>(ny));
            if (k > model.k_max()) break;
            modes.push_back({nx, ny, (nx > 0 ? 2.0 : 1.0) * (ny > 0 ? 2.0 : 1.0), model.shares(k)});
        }
    }
    return modes;
}

}  // namespace

double window_power(double q) {
    // The integrand over the directions has no harmonics beyond √2 q (the window's own correlation
    // is that wide) but for a tail, and only each fourth: the trapezoidal rule is as good as exact.
    const double harmonics = std::numbers::sqrt2 * q + 20 + 10 * std::cbrt(q);
    const int n = std::max(4, static_cast<int>(std::ceil(harmonics / 8)));
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
        const double angle = 0.25 * pi * i / n;
        const double value =
            squared_sinc(0.5 * q * std::cos(angle)) * squared_sinc(0.5 * q * std::sin(angle));
        sum += i == 0 || i == n ? 0.5 * value : value;
    }
    return sum / n;
}

std::vector<SyntheticVariance> synthetic_variance(const SpectrumModel& model, double density,
                                                  const std::vector<double>& windows) {
    std::vector<SyntheticVariance> result;
    for (const double window : windows) result.push_back(in_infinite_box(model, density, window));
    return result;
}

std::vector<SyntheticVariance> synthetic_variance(const SpectrumModel& model, double density,
                                                  double side, const std::vector<double>& windows) {
    const double step = 2 * pi / side;
    const double steps = std::floor(model.k_max() / step * (1 + 1e-12));
    if (steps > most_steps) {
        throw OptionError({.problem = fmt::format("the sum over wavevectors is too long for a box "
                                                  "of {:.6g} a",
                                                  side),
                           .actual = fmt::format("{:.3g} wavevectors an axis", steps),
                           .expected = fmt::format("at most {:.3g}", most_steps),
                           .suggestion = "ask for an infinite box (inf), or lower sk.k-max"});
    }
    const auto most = static_cast<std::size_t>(steps);
    const std::vector<QuadrantMode> modes = quadrant(model, step, most);
    std::vector<SyntheticVariance> result;
    std::vector<double> power(most + 1);
    for (const double window : windows) {
        for (std::size_t n = 0; n <= most; ++n) {
            power[n] = squared_sinc(0.5 * step * static_cast<double>(n) * window);
        }
        std::vector<double> jacobian(model.size(), 0.0);
        double poisson = 0;  // what S = 1 would give
        for (const QuadrantMode& mode : modes) {
            const double w = mode.count * power[mode.nx] * power[mode.ny];
            poisson += w;
            for (const SpectrumModel::Share& share : mode.shares) {
                if (share.weight != 0) jacobian[share.parameter] += share.weight * w;
            }
        }
        const double share = window * window / (side * side);
        const double unit = density * window * window * share;
        // The wavevectors beyond k_max: what is left of fixed-number Poisson.
        const double beyond =
            model.tail() * (density * window * window * (1 - share) - unit * poisson);
        double within = 0;
        for (std::size_t p = 0; p < jacobian.size(); ++p) within += jacobian[p] * model.theta()[p];
        result.push_back(
            {beyond + unit * within, unit * std::sqrt(model.variance(jacobian)), beyond});
    }
    return result;
}

}  // namespace grainfield::analysis
