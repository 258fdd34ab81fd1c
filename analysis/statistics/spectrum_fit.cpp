#include "analysis/statistics/spectrum_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

namespace grainfield::analysis {
namespace {

constexpr double least_alpha = 0.2;
constexpr double largest_alpha = 4;
constexpr double least_rise = 2;  // standard errors of S1

// The shells inside the range.
struct Points {
    std::vector<double> log_k, s, weight;  // weight: ν, or S²/error² for least squares
    std::size_t size() const { return s.size(); }
};

Points points_of(const Spectrum& spectrum, double k_max, FitMethod method) {
    Points points;
    for (std::size_t i = 0; i < spectrum.k.size(); ++i) {
        const double k = spectrum.k[i];
        if (!(k > 0) || !(k <= k_max * (1 + 1e-12)) || !std::isfinite(spectrum.s[i])) continue;
        const double nu = spectrum.dof[i];
        double weight = nu;
        if (method == FitMethod::least_squares)
            weight = 1 / (spectrum.error[i] * spectrum.error[i]);
        if (!(weight > 0) || !std::isfinite(weight) || !(spectrum.s[i] > 0)) continue;
        points.log_k.push_back(std::log(k));
        points.s.push_back(spectrum.s[i]);
        points.weight.push_back(weight);
    }
    return points;
}

struct Line {
    double s0 = 0;
    double s1 = 0;
    double objective = -std::numeric_limits<double>::infinity();  // ln L, or −χ²/2
};

double log_likelihood(const Points& points, const std::vector<double>& x, double s0, double s1) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double mu = s0 + s1 * x[i];
        if (!(mu > 0)) return -std::numeric_limits<double>::infinity();
        sum -= points.weight[i] * (std::log(mu) + points.s[i] / mu);
    }
    return sum;
}

// The weighted line through (x, s); nothing if all x are the same.
std::optional<Line> weighted_line(const std::vector<double>& x, const std::vector<double>& s,
                                  const std::vector<double>& w) {
    double sw = 0, sx = 0, sy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sw += w[i];
        sx += w[i] * x[i];
        sy += w[i] * s[i];
    }
    const double mx = sx / sw;
    const double my = sy / sw;
    double sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sxx += w[i] * (x[i] - mx) * (x[i] - mx);
        sxy += w[i] * (x[i] - mx) * (s[i] - my);
    }
    if (!(sxx > 0)) return std::nullopt;
    const double slope = sxy / sxx;
    return Line{my - slope * mx, slope, 0};
}

std::vector<double> powers(const Points& points, double alpha) {
    std::vector<double> x;
    for (double l : points.log_k) x.push_back(std::exp(alpha * l));
    return x;
}

// Largest likelihood over S0 and S1 at a given α.
std::optional<Line> best_line(const Points& points, double alpha, FitMethod method) {
    const std::vector<double> x = powers(points, alpha);
    if (method == FitMethod::least_squares) {
        auto line = weighted_line(x, points.s, points.weight);
        if (!line) return line;
        line->objective = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double d = points.s[i] - line->s0 - line->s1 * x[i];
            line->objective -= 0.5 * points.weight[i] * d * d;
        }
        return line;
    }
    // A constant is always allowed: a start with μ > 0.
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sum += points.weight[i] * points.s[i];
        weight += points.weight[i];
    }
    Line line{sum / weight, 0, 0};
    line.objective = log_likelihood(points, x, line.s0, line.s1);
    std::vector<double> w(x.size());
    for (int step = 0; step < 200; ++step) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double mu = line.s0 + line.s1 * x[i];
            w[i] = points.weight[i] / (mu * mu);
        }
        const auto target = weighted_line(x, points.s, w);
        if (!target) return std::nullopt;
        double share = 1;
        Line next;
        for (; share > 1e-10; share /= 2) {
            next = {line.s0 + share * (target->s0 - line.s0),
                    line.s1 + share * (target->s1 - line.s1), 0};
            next.objective = log_likelihood(points, x, next.s0, next.s1);
            if (next.objective >= line.objective) break;
        }
        if (!(next.objective >= line.objective)) return line;
        const double change = std::abs(next.s0 - line.s0) + std::abs(next.s1 - line.s1) * x.back();
        line = next;
        if (change <= 1e-13 * (std::abs(line.s0) + std::abs(line.s1) * x.back())) break;
    }
    return line;
}

// The α in [0.2, 4] at which `objective` is largest: a scan, then golden section.
template <class Objective>
double best_alpha(const Objective& objective) {
    constexpr int scan = 38;
    const double step = (largest_alpha - least_alpha) / scan;
    double best = least_alpha;
    double value = -std::numeric_limits<double>::infinity();
    for (int i = 0; i <= scan; ++i) {
        const double here = objective(least_alpha + i * step);
        if (here > value) std::tie(best, value) = std::pair{least_alpha + i * step, here};
    }
    double low = std::max(least_alpha, best - step);
    double high = std::min(largest_alpha, best + step);
    constexpr double golden = 0.618033988749895;
    double a = high - golden * (high - low);
    double b = low + golden * (high - low);
    double at_a = objective(a);
    double at_b = objective(b);
    while (high - low > 1e-8) {
        if (at_a > at_b) {
            high = std::exchange(b, std::exchange(a, b - golden * (b - low)));
            at_b = std::exchange(at_a, objective(a));
        } else {
            low = std::exchange(a, std::exchange(b, a + golden * (high - a)));
            at_a = std::exchange(at_b, objective(b));
        }
    }
    return 0.5 * (low + high);
}

SpectrumFit without(std::string reason) {
    SpectrumFit fit;
    fit.reason = std::move(reason);
    return fit;
}

// Why an exponent that was searched is none.
std::optional<std::string> at_the_end(double alpha) {
    if (alpha > least_alpha + 1e-6 && alpha < largest_alpha - 1e-6) return std::nullopt;
    return fmt::format("the exponent runs to the end of its range, {:.2g}", alpha);
}

SpectrumFit finish(const Points& points, const Line& line, double alpha, bool alpha_is_free,
                   FitMethod method) {
    SpectrumFit fit;
    fit.s0 = line.s0;
    fit.s1 = line.s1;
    fit.alpha = alpha;
    fit.log_likelihood = line.objective;
    fit.points = static_cast<int>(points.size());
    const std::vector<double> x = powers(points, alpha);
    // Scaled to the largest x, so that the matrix is well conditioned.
    const double scale = x.back();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double mu = line.s0 + line.s1 * x[i];
        const bool whittle = method == FitMethod::whittle;
        const double w = whittle ? points.weight[i] / (mu * mu) : points.weight[i];
        const Eigen::Vector3d g{1, x[i] / scale, line.s1 * x[i] * points.log_k[i]};
        information += w * g * g.transpose();
        fit.chi2 += w * (points.s[i] - mu) * (points.s[i] - mu);
    }
    const int free = alpha_is_free ? 3 : 2;
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(information.topLeftCorner(free, free));
    if (!(lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0)) {
        return without("the points do not determine the parameters");
    }
    const Eigen::MatrixXd covariance = lu.inverse();
    fit.error = {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)) / scale,
                 alpha_is_free ? std::sqrt(covariance(2, 2)) : 0};
    fit.covariance = covariance(0, 1) / scale;
    for (double e : fit.error) {
        if (!std::isfinite(e)) return without("the points do not determine the parameters");
    }
    return fit;
}

}  // namespace

bool rises(double s1, double error) {
    return s1 > least_rise * error;
}

std::string no_rise(double s1, double error) {
    if (std::isnan(error)) return "S1 has no error: whether S grows with k is not known";
    const std::string number = fmt::format("S1 = {:.2g} ± {:.2g}", s1, error);
    if (s1 > 0) {
        const double factor = std::ceil(std::pow(least_rise * error / s1, 2) - 1e-9);
        return fmt::format(
            "S is not known to grow with k: {}; a run {:.0f} times as long would tell it from "
            "zero, if it stays",
            number, factor);
    }
    const std::string what = "S does not grow with k in its range: " + number;
    if (s1 < -least_rise * error) {
        return what +
               "; S falls, and no length of the run makes up for that: does the layer separate, or "
               "is the end of the fit (--fit-k-max) too far out?";
    }
    return what +
           fmt::format(
               "; its sign is not known: a run four times as long would show an S1 of {:.2g}",
               error);
}

double SpectrumFit::ratio_error() const {
    const double r = ratio();
    const double variance = error[0] * error[0] + r * r * error[1] * error[1] - 2 * r * covariance;
    return std::sqrt(std::max(0.0, variance)) / std::abs(s1);
}

double SpectrumFit::value(double k) const {
    return s0 + s1 * std::pow(k, alpha);
}

double SpectrumFit::value_error(double k) const {
    const double x = std::pow(k, alpha);
    const double variance = error[0] * error[0] + x * x * error[1] * error[1] + 2 * x * covariance;
    return std::sqrt(std::max(0.0, variance));
}

SpectrumFit fit_spectrum(const Spectrum& spectrum, double k_max, std::optional<double> alpha,
                         FitMethod method) {
    const Points points = points_of(spectrum, k_max, method);
    const std::size_t least = alpha ? 3 : 4;
    if (points.size() < least) {
        return without(fmt::format("{} shells with an error up to k = {:.3g} /a, {} are needed",
                                   points.size(), k_max, least));
    }
    const auto at = [&](double a) {
        const auto line = best_line(points, a, method);
        return line ? line->objective : -std::numeric_limits<double>::infinity();
    };
    const double exponent = alpha ? *alpha : best_alpha(at);
    const auto line = best_line(points, exponent, method);
    if (!line || !std::isfinite(line->objective)) return without("the fit does not converge");
    if (const auto reason = at_the_end(exponent); !alpha && reason) return without(*reason);
    SpectrumFit fit = finish(points, *line, exponent, !alpha, method);
    fit.k_max = k_max;
    return fit;
}

std::vector<SpectrumFit> fit_shared(std::span<const Spectrum> spectra,
                                    std::span<const double> k_max) {
    std::vector<Points> points;
    std::vector<SpectrumFit> fits;
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        fits.push_back(fit_spectrum(spectra[i], k_max[i], 1.0));
        if (fits.back().ok()) {
            points.push_back(points_of(spectra[i], k_max[i], FitMethod::whittle));
        }
    }
    if (points.empty()) return fits;
    const double alpha = best_alpha([&](double a) {
        double sum = 0;
        for (const Points& p : points) {
            const auto line = best_line(p, a, FitMethod::whittle);
            sum += line ? line->objective : -std::numeric_limits<double>::infinity();
        }
        return sum;
    });
    if (const auto reason = at_the_end(alpha)) {
        for (SpectrumFit& fit : fits) {
            if (fit.ok()) fit = without(*reason);
        }
        return fits;
    }
    double information = 0;  // of alpha, after S0 and S1
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        if (!fits[i].ok()) continue;
        const double free = [&] {
            const Points p = points_of(spectra[i], k_max[i], FitMethod::whittle);
            const auto line = best_line(p, alpha, FitMethod::whittle);
            return line ? finish(p, *line, alpha, true, FitMethod::whittle).error[2] : 0.0;
        }();
        if (free > 0) information += 1 / (free * free);
        fits[i] = fit_spectrum(spectra[i], k_max[i], alpha);
    }
    for (SpectrumFit& fit : fits) {
        if (fit.ok() && information > 0) fit.error[2] = 1 / std::sqrt(information);
    }
    return fits;
}

std::optional<Interval> ratio_interval(const Spectrum& spectrum, const SpectrumFit& fit) {
    if (!fit.ok() || !(fit.s1 > 0)) return std::nullopt;
    const Points points = points_of(spectrum, fit.k_max, FitMethod::whittle);
    const std::vector<double> x = powers(points, fit.alpha);
    const double best = log_likelihood(points, x, fit.s0, fit.s1);
    // At a given ratio r the best S1 is the weighted mean of S/(r + x).
    const auto loss = [&](double r) {
        double sum = 0, weight = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (!(r + x[i] > 0)) return std::numeric_limits<double>::infinity();
            sum += points.weight[i] * points.s[i] / (r + x[i]);
            weight += points.weight[i];
        }
        const double s1 = sum / weight;
        return best - log_likelihood(points, x, r * s1, s1) - 0.5;
    };
    const double r = fit.ratio();
    const auto edge = [&](double sign) -> std::optional<double> {
        double inside = r;
        double step = std::max(fit.ratio_error(), 1e-12);
        double outside = r + sign * step;
        for (int i = 0; loss(outside) < 0; ++i, step *= 2) {
            if (i == 60) return std::nullopt;
            inside = outside;
            outside += sign * step;
        }
        for (int i = 0; i < 100; ++i) {
            const double middle = 0.5 * (inside + outside);
            (loss(middle) < 0 ? inside : outside) = middle;
        }
        return 0.5 * (inside + outside);
    };
    const auto low = edge(-1);
    const auto high = edge(+1);
    if (!low || !high) return std::nullopt;
    return Interval{*low, *high};
}

PrePeak find_pre_peak(const Spectrum& spectrum, double smoothing) {
    const Points points =
        points_of(spectrum, std::numeric_limits<double>::infinity(), FitMethod::whittle);
    if (points.size() < 8) return {std::nullopt, "too few shells to look for a pre-peak"};
    // Local lines on an even grid of ln k.
    const double low = points.log_k.front();
    const double high = points.log_k.back();
    const int steps = std::max(16, static_cast<int>(std::ceil((high - low) / (0.1 * smoothing))));
    std::vector<double> at, y, error;
    for (int i = 0; i <= steps; ++i) {
        const double l = low + (high - low) * i / steps;
        std::vector<double> x, s, w;
        double weight = 0, squares = 0;
        for (std::size_t j = 0; j < points.size(); ++j) {
            const double u = (points.log_k[j] - l) / smoothing;
            if (std::abs(u) > 4) continue;
            x.push_back(points.log_k[j] - l);
            s.push_back(points.s[j]);
            w.push_back(points.weight[j] * std::exp(-0.5 * u * u));
            weight += w.back();
            squares += w.back() * w.back() / points.weight[j];
        }
        const auto line = x.size() < 3 ? std::nullopt : weighted_line(x, s, w);
        if (!line || !(line->s0 > 0)) continue;
        at.push_back(l);
        y.push_back(line->s0);
        error.push_back(line->s0 * std::sqrt(squares) / weight);
    }
    const auto clear = [&](std::size_t peak, std::size_t other) {
        return y[peak] - y[other] > 4 * std::hypot(error[peak], error[other]);
    };
    for (std::size_t i = 1; i + 1 < y.size(); ++i) {
        if (!(y[i] > y[i - 1] && y[i] >= y[i + 1])) continue;
        bool rises = false, falls = false;
        for (std::size_t j = 0; j < i && !rises; ++j) rises = clear(i, j);
        for (std::size_t j = i + 1; j < y.size() && y[j] <= y[i] && !falls; ++j) {
            falls = clear(i, j);
        }
        if (!rises || !falls) continue;
        const double bend = y[i - 1] - 2 * y[i] + y[i + 1];
        const double shift = bend < 0 ? 0.5 * (y[i - 1] - y[i + 1]) / bend : 0;
        return {std::exp(at[i] + shift * (at[i + 1] - at[i])), ""};
    }
    return {std::nullopt, "S(k) has no maximum that stands out from its error"};
}

}  // namespace grainfield::analysis
