#include "analysis/statistics/critical_power.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <fmt/format.h>

namespace grainfield::analysis {
namespace {

constexpr double least_power = 0.02;
constexpr double largest_power = 8;

CriticalPower refused(std::string reason) {
    CriticalPower fit;
    fit.reason = std::move(reason);
    return fit;
}

// ratio/error and the columns of the model over the error.
struct Weighted {
    std::span<const CriticalPoint> points;
    double reference = 1;
    bool has_constant = false;

    Eigen::VectorXd values() const {
        Eigen::VectorXd y(static_cast<Eigen::Index>(points.size()));
        for (std::size_t i = 0; i < points.size(); ++i) {
            y[static_cast<Eigen::Index>(i)] = points[i].ratio / points[i].error;
        }
        return y;
    }

    // The constant, and (x/reference)^power.
    Eigen::MatrixX2d columns(double power) const {
        Eigen::MatrixX2d a(static_cast<Eigen::Index>(points.size()), 2);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            a(row, 0) = has_constant ? 1 / points[i].error : 0;
            a(row, 1) = std::pow(points[i].x / reference, power) / points[i].error;
        }
        return a;
    }
};

// The error of a number with these slopes against constant, scaled factor and power.
double propagated(const std::array<std::array<double, 3>, 3>& covariance,
                  const std::array<double, 3>& slopes) {
    double variance = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) variance += slopes[i] * covariance[i][j] * slopes[j];
    }
    return std::sqrt(std::max(0.0, variance));
}

struct Best {
    Eigen::Vector2d parameters = Eigen::Vector2d::Zero();
    double chi2 = std::numeric_limits<double>::infinity();
};

Best at_power(const Weighted& data, double power) {
    const Eigen::MatrixX2d a = data.columns(power);
    const Eigen::VectorXd y = data.values();
    Best best;
    if (!data.has_constant) {
        best.parameters[1] = a.col(1).dot(y) / a.col(1).squaredNorm();
    } else {
        best.parameters = (a.transpose() * a).ldlt().solve(a.transpose() * y);
    }
    best.chi2 = (y - a * best.parameters).squaredNorm();
    return best;
}

// The power with the least chi2: a scan in ln power, then golden section.
double best_power(const Weighted& data) {
    constexpr int scan = 60;
    const double low_end = std::log(least_power);
    const double step = (std::log(largest_power) - low_end) / scan;
    const auto chi2 = [&](double log_power) { return at_power(data, std::exp(log_power)).chi2; };
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= scan; ++i) {
        const double here = chi2(low_end + i * step);
        if (here < least) std::tie(best, least) = std::pair{i, here};
    }
    double low = low_end + std::max(0, best - 1) * step;
    double high = low_end + std::min(scan, best + 1) * step;
    constexpr double golden = 0.618033988749895;
    while (high - low > 1e-9) {
        const double a = high - golden * (high - low);
        const double b = low + golden * (high - low);
        (chi2(a) < chi2(b) ? high : low) = chi2(a) < chi2(b) ? b : a;
    }
    return std::exp(0.5 * (low + high));
}

}  // namespace

double CriticalPower::value(double x) const {
    return constant + factor * std::pow(x, power);
}

double CriticalPower::value_error(double x) const {
    if (!(x > 0)) return constant_error;
    const double scaled = std::pow(x / reference, power);
    const double at_reference = factor * std::pow(reference, power);
    return propagated(covariance, {1, scaled, at_reference * scaled * std::log(x / reference)});
}

CriticalPower fit_critical_power(std::span<const CriticalPoint> points, PowerConstant constant) {
    const bool has_constant = constant == PowerConstant::free;
    const std::size_t least = has_constant ? 3 : 2;
    double sum = 0;
    for (const CriticalPoint& p : points) {
        if (!(p.x > 0) || !std::isfinite(p.x)) {
            return refused(fmt::format(
                "a power of the control parameter needs values above 0, and one is {}", p.x));
        }
        if (!std::isfinite(p.ratio) || !(p.error > 0)) {
            return refused(fmt::format("the point at {} has no value or no error", p.x));
        }
        sum += std::log(p.x);
    }
    if (points.size() < least) {
        return refused(fmt::format("{} run{} with S0/S1 and its error, {} are needed",
                                   points.size(), points.size() == 1 ? "" : "s", least));
    }
    const auto [first, last] = std::ranges::minmax(points, {}, &CriticalPoint::x);
    if (!(first.x < last.x))
        return refused("all runs have the same value of the control parameter");

    CriticalPower fit;
    fit.reference = std::exp(sum / static_cast<double>(points.size()));
    const Weighted data{points, fit.reference, has_constant};
    fit.power = best_power(data);
    if (fit.power < least_power * 1.001 || fit.power > largest_power * 0.999) {
        return refused(
            fmt::format("the power runs to the end of its range, {:.2g}: S0/S1 does not grow with "
                        "the control parameter as a power",
                        fit.power));
    }
    const Best best = at_power(data, fit.power);
    fit.points = static_cast<int>(points.size());
    fit.chi2 = best.chi2;
    fit.constant = best.parameters[0];
    fit.factor = best.parameters[1] * std::pow(fit.reference, -fit.power);

    // Columns: constant, factor at the reference, power.
    const Eigen::MatrixX2d a = data.columns(fit.power);
    Eigen::MatrixX3d slopes(a.rows(), 3);
    slopes.leftCols<2>() = a;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        slopes(row, 2) = best.parameters[1] * a(row, 1) * std::log(points[i].x / fit.reference);
    }
    const Eigen::Index free = has_constant ? 3 : 2;
    const Eigen::MatrixXd used = slopes.rightCols(free);
    const Eigen::LDLT<Eigen::MatrixXd> information(used.transpose() * used);
    const Eigen::MatrixXd inverse = information.solve(Eigen::MatrixXd::Identity(free, free));
    if (!inverse.allFinite() || !(inverse.diagonal().minCoeff() > 0)) {
        return refused("the runs do not determine the power");
    }
    for (Eigen::Index i = 0; i < free; ++i) {
        for (Eigen::Index j = 0; j < free; ++j) {
            const auto row = static_cast<std::size_t>(3 - free + i);
            fit.covariance[row][static_cast<std::size_t>(3 - free + j)] = inverse(i, j);
        }
    }
    fit.constant_error = std::sqrt(fit.covariance[0][0]);
    fit.power_error = std::sqrt(fit.covariance[2][2]);
    const double scale = std::pow(fit.reference, -fit.power);  // of the factor, to x = 1
    fit.factor_error = propagated(
        fit.covariance, {0, scale, -best.parameters[1] * scale * std::log(fit.reference)});
    return fit;
}

}  // namespace grainfield::analysis
