#include "analysis/statistics/ornstein_zernike.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>

namespace grainfield::analysis {
namespace {

struct Shell {
    double k2, s, nu;
};

struct Line {
    double p = 0;
    double q = 0;
};

// Gradient and minus the second derivatives of ln L.
struct Slope {
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // minus the second derivatives
};

double log_likelihood(const std::vector<Shell>& shells, const Line& line) {
    double sum = 0;
    for (const Shell& shell : shells) {
        const double inverse = line.p + line.q * shell.k2;
        if (!(inverse > 0)) return -std::numeric_limits<double>::infinity();
        sum += shell.nu * (std::log(inverse) - shell.s * inverse);
    }
    return sum;
}

Slope slope_at(const std::vector<Shell>& shells, const Line& line) {
    Slope slope;
    for (const Shell& shell : shells) {
        const double mean = 1 / (line.p + line.q * shell.k2);
        const Eigen::Vector2d of_shell{1, shell.k2};
        slope.gradient += shell.nu * (mean - shell.s) * of_shell;
        slope.information += shell.nu * mean * mean * of_shell * of_shell.transpose();
    }
    return slope;
}

// From a flat spectrum, which is always inside.
Line maximum(const std::vector<Shell>& shells) {
    double weight = 0;
    double sum = 0;
    for (const Shell& shell : shells) {
        weight += shell.nu;
        sum += shell.nu * shell.s;
    }
    Line line{weight / sum, 0};
    double best = log_likelihood(shells, line);
    for (int step = 0; step < 200; ++step) {
        const Slope slope = slope_at(shells, line);
        const Eigen::Vector2d step_along = slope.information.inverse() * slope.gradient;
        const Line along{step_along[0], step_along[1]};
        double share = 1;
        bool better = false;
        for (int halving = 0; halving < 60 && !better; ++halving, share /= 2) {
            const Line next{line.p + share * along.p, line.q + share * along.q};
            const double reached = log_likelihood(shells, next);
            if (!(reached >= best)) continue;
            better = reached - best > 1e-13 * std::abs(best);
            line = next;
            best = reached;
            break;
        }
        if (!better) break;
    }
    return line;
}

}  // namespace

double OrnsteinZernikeFit::value(double k) const {
    return s_zero / (1 + xi * xi * k * k);
}

OrnsteinZernikeFit fit_ornstein_zernike(const Spectrum& spectrum, double k_max) {
    OrnsteinZernikeFit fit;
    std::vector<Shell> shells;
    for (std::size_t i = 0; i < spectrum.k.size() && spectrum.k[i] <= k_max; ++i) {
        if (!(spectrum.s[i] > 0) || !(spectrum.dof[i] > 0)) continue;
        shells.push_back({spectrum.k[i] * spectrum.k[i], spectrum.s[i], spectrum.dof[i]});
        fit.k_max = spectrum.k[i];
    }
    fit.points = static_cast<int>(shells.size());
    const auto without = [&](std::string reason) {
        OrnsteinZernikeFit none;
        none.reason = std::move(reason);
        return none;
    };
    if (fit.points < 3) {
        return without(
            fmt::format("{} shells below k = {:.3g} /a, at least 3 are needed", fit.points, k_max));
    }
    const Line line = maximum(shells);
    if (!(line.q > 0)) return without("S does not fall with k");
    if (!(line.p > 0)) return without("S has no finite limit at k = 0");
    double chi2 = 0;
    for (const Shell& shell : shells) {
        const double ratio = shell.s * (line.p + line.q * shell.k2);
        chi2 += shell.nu * (ratio - 1) * (ratio - 1);
    }
    fit.chi2_per_dof = chi2 / (fit.points - 2);
    const Eigen::Matrix2d covariance =
        std::max(1.0, fit.chi2_per_dof) * slope_at(shells, line).information.inverse();
    const double var_p = covariance(0, 0);
    const double var_q = covariance(1, 1);
    const double cov = covariance(0, 1);
    fit.s_zero = 1 / line.p;
    fit.s_zero_error = std::sqrt(var_p) / (line.p * line.p);
    fit.xi = std::sqrt(line.q / line.p);
    const double relative = var_q / (line.q * line.q) + var_p / (line.p * line.p) -
                            2 * cov / (line.p * line.q);  // of ξ²
    fit.xi_error = 0.5 * fit.xi * std::sqrt(std::max(0.0, relative));
    return fit;
}

}  // namespace grainfield::analysis
