#include "bench/tracking/mirror_regression.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

namespace grainfield::bench {
namespace {

using namespace grainfield::tracking;

constexpr std::array<double, 4> kRidges = {1e-6, 1e-5, 1e-4, 1e-3};
constexpr Eigen::Index kAll = kTerms * static_cast<Eigen::Index>(GeneralCorrection::kFilmTerms);

/// Sums over cameras. Within one camera what a weight depends on is one number, so that the sums
/// over its terms are made once.
struct Sums {
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kAll, kAll);
    Eigen::VectorXd product = Eigen::VectorXd::Zero(kAll);
    double rows = 0;

    void add(const MirrorLesson& lesson) {
        const auto film = GeneralCorrection::film_terms(lesson.width, lesson.diameter);
        const Eigen::MatrixXd exact = lesson.terms.cast<double>();
        Eigen::MatrixXd own = Eigen::MatrixXd::Zero(kTerms, kTerms);
        own.selfadjointView<Eigen::Lower>().rankUpdate(exact.transpose());
        own.triangularView<Eigen::StrictlyUpper>() = own.transpose();
        const Eigen::VectorXd with_lacks = exact.transpose() * lesson.lacks;
        for (std::size_t p = 0; p < film.size(); ++p) {
            const auto row = static_cast<Eigen::Index>(p) * kTerms;
            product.segment(row, kTerms) += film[p] * with_lacks;
            for (std::size_t q = 0; q < film.size(); ++q) {
                squares.block(row, static_cast<Eigen::Index>(q) * kTerms, kTerms, kTerms) +=
                    film[p] * film[q] * own;
            }
        }
        rows += static_cast<double>(lesson.lacks.size());
    }
};

Eigen::VectorXd weights_of(const Sums& sums, double ridge) {
    // In units of their own RMS all terms are shrunk alike.
    const Eigen::VectorXd scale =
        (sums.squares.diagonal().array() / sums.rows + 1e-24).sqrt().inverse().matrix();
    Eigen::MatrixXd matrix = scale.asDiagonal() * sums.squares * scale.asDiagonal();
    matrix.diagonal().array() += ridge * sums.rows;
    const Eigen::LLT<Eigen::MatrixXd> factor = matrix.llt();
    if (factor.info() != Eigen::Success) throw std::runtime_error("the sums cannot be solved for");
    const Eigen::VectorXd solved = factor.solve(scale.asDiagonal() * sums.product);
    return scale.asDiagonal() * solved;
}

Eigen::VectorXd shift_by(const Eigen::VectorXd& weights, const MirrorLesson& lesson) {
    const auto film = GeneralCorrection::film_terms(lesson.width, lesson.diameter);
    Eigen::VectorXd here = Eigen::VectorXd::Zero(kTerms);
    for (std::size_t p = 0; p < film.size(); ++p) {
        here += film[p] * weights.segment(static_cast<Eigen::Index>(p) * kTerms, kTerms);
    }
    return lesson.terms.cast<double>() * here;
}

double rms(const Eigen::VectorXd& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// A corrected position of a camera left out, along one axis [a].
struct Corrected {
    double left = 0;   ///< its error, without sign
    double error = 0;  ///< standard error of the disc
    double least = 0;  ///< that the noise of the camera alone makes
    double shift = 0;  ///< by the correction, without sign
    std::size_t overlap = 0;

    double sigma(const RemainingErrors& errors) const {
        return std::hypot(std::max(errors.shares[overlap] * error, least), errors.doubt * shift);
    }
};

double share_within(const std::vector<const Corrected*>& positions, const RemainingErrors& errors) {
    std::size_t within = 0;
    for (const Corrected* c : positions) within += c->left <= 2 * c->sigma(errors);
    return static_cast<double>(within) / static_cast<double>(positions.size());
}

constexpr double kWithin = 0.954;

/// `shares` with which, for a given doubt, 95.4 % of each class of overlap lie within two standard
/// errors. Every sphere counts alike.
void find_shares(const std::vector<std::vector<const Corrected*>>& by_overlap,
                 RemainingErrors& errors) {
    errors.shares.assign(kOverlapClasses, 1);
    for (std::size_t overlap = 0; overlap < by_overlap.size(); ++overlap) {
        if (by_overlap[overlap].empty()) continue;
        double low = 0;
        double high = 1;
        for (int halving = 0; halving < 14; ++halving) {
            double& share = errors.shares[overlap];
            share = 0.5 * (low + high);
            (share_within(by_overlap[overlap], errors) < kWithin ? low : high) = share;
        }
    }
}

/// The doubt with which the tenths of all positions by shift/error have the most even share within
/// two standard errors, and its shares.
RemainingErrors remaining_errors(const std::vector<Corrected>& positions) {
    constexpr std::size_t kTenths = 10;
    std::vector<std::vector<const Corrected*>> by_overlap(kOverlapClasses);
    std::vector<const Corrected*> sorted;
    for (const Corrected& c : positions) {
        by_overlap[c.overlap].push_back(&c);
        sorted.push_back(&c);
    }
    std::sort(sorted.begin(), sorted.end(), [](const Corrected* a, const Corrected* b) {
        return a->shift / a->error < b->shift / b->error;
    });
    std::vector<std::vector<const Corrected*>> tenths(kTenths);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        tenths[i * kTenths / sorted.size()].push_back(sorted[i]);
    }
    RemainingErrors tried;
    RemainingErrors best;
    double least = 0;
    for (int step = 0; step <= 50; ++step) {
        tried.doubt = 0.01 * step;
        find_shares(by_overlap, tried);
        double uneven = 0;
        std::string line;
        for (const auto& tenth : tenths) {
            const double within = share_within(tenth, tried);
            uneven += (within - kWithin) * (within - kWithin);
            line += fmt::format(" {:.3f}", within);
        }
        fmt::print(stderr, "doubt {:.2f}: within 2σ{}\n", tried.doubt, line);
        if (step > 0 && uneven >= least) continue;
        least = uneven;
        best = tried;
    }
    return best;
}

/// What the regression with the best ridge leaves of cameras left out.
struct LeftOut {
    double ridge = 0;
    std::vector<Eigen::VectorXd> left;   ///< what positions still lack [a]
    std::vector<Eigen::VectorXd> shift;  ///< by the correction [a]
};

LeftOut leave_out(const std::vector<MirrorLesson>& lessons, const std::vector<Sums>& folds,
                  const Sums& all) {
    LeftOut best;
    double least = 0;
    for (const double ridge : kRidges) {
        LeftOut tried{ridge, std::vector<Eigen::VectorXd>(lessons.size()),
                      std::vector<Eigen::VectorXd>(lessons.size())};
        double sum = 0;
        for (std::size_t fold = 0; fold < kFolds; ++fold) {
            const Sums others{all.squares - folds[fold].squares, all.product - folds[fold].product,
                              all.rows - folds[fold].rows};
            const Eigen::VectorXd weights = weights_of(others, ridge);
            for (std::size_t k = fold; k < lessons.size(); k += kFolds) {
                tried.shift[k] = shift_by(weights, lessons[k]);
                tried.left[k] = lessons[k].lacks - tried.shift[k];
                sum += std::log(rms(tried.left[k]));  // every camera counts alike
            }
        }
        fmt::print(stderr, "ridge {:g}: {:.5f} a, geometric mean\n", ridge,
                   std::exp(sum / static_cast<double>(lessons.size())));
        if (!best.left.empty() && sum >= least) continue;
        least = sum;
        best = std::move(tried);
    }
    return best;
}

/// By camera.
std::vector<std::vector<Corrected>> corrected_positions(const std::vector<MirrorLesson>& lessons,
                                                        const LeftOut& best) {
    std::vector<std::vector<Corrected>> corrected;
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        const std::size_t n = lessons[k].spheres();
        auto& of_camera = corrected.emplace_back();
        for (std::size_t i = 0; i < 2 * n; ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            of_camera.push_back({.left = std::abs(best.left[k](row)),
                                 .error = lessons[k].error(row),
                                 .least = lessons[k].least(row),
                                 .shift = std::abs(best.shift[k](row)),
                                 .overlap = lessons[k].overlap[i % n]});
        }
    }
    return corrected;
}

}  // namespace

MirrorRegression regress(const std::vector<MirrorLesson>& lessons) {
    std::vector<Sums> folds(kFolds);
    for (std::size_t k = 0; k < lessons.size(); ++k) folds[k % kFolds].add(lessons[k]);
    Sums all;
    for (const Sums& fold : folds) {
        all.squares += fold.squares;
        all.product += fold.product;
        all.rows += fold.rows;
    }
    const LeftOut best = leave_out(lessons, folds, all);
    const std::vector<std::vector<Corrected>> corrected = corrected_positions(lessons, best);
    std::vector<Corrected> of_all;
    for (const auto& of_camera : corrected) {
        of_all.insert(of_all.end(), of_camera.begin(), of_camera.end());
    }
    MirrorRegression result;
    result.ridge = best.ridge;
    result.errors = remaining_errors(of_all);
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        int within = 0;
        for (const Corrected& c : corrected[k]) within += c.left <= 2 * c.sigma(result.errors);
        result.cameras.push_back(
            {.before = rms(lessons[k].lacks),
             .after = rms(best.left[k]),
             .within = within / (2.0 * static_cast<double>(lessons[k].spheres()))});
    }
    const Eigen::VectorXd weights = weights_of(all, best.ridge);
    for (Eigen::Index k = 0; k < kTerms; ++k) {
        result.weights.push_back({weights(k), weights(kTerms + k), weights(2 * kTerms + k)});
    }
    return result;
}

}  // namespace grainfield::bench
