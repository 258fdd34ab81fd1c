#include "bench/tracking/mirror_patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "bench/tracking/rimmed_discs.h"
#include "bench/tracking/share_of_values.h"
#include "core/errors.h"
#include "core/run_plan.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/film_model.h"
#include "tracking/synthesis/bias_terms.h"

namespace grainfield::bench {
namespace {

using namespace grainfield::tracking;

constexpr int kLeastSpheres = 100;
/// Less beside the noise is no misfit to learn a pattern from.
constexpr double kLeastMisfit = 0.5;
/// To describe a kind: two for each of its numbers.
constexpr std::size_t kLeastPatterns = 2 * ResidualPattern::kNumbers;

/// By pixels, as judge_correction sees it.
std::optional<ResidualPattern::Numbers> pattern_of(const Image& counts, double scale,
                                                   const TrackOptions& options) {
    CalibrationOptions calibration;
    calibration.binning.factor = mirror_blocks(scale);
    RunPlan plan;
    const auto calibrated =
        calibrate(counts, calibration, options.detection, options.refinement, 2, plan);
    if (!calibrated) return std::nullopt;
    constexpr std::size_t n = ResidualPattern::kNumbers;
    GeneralCorrection nothing;
    nothing.weights.assign(BiasTerms::kCount, {});
    nothing.shares.assign(kOverlapClasses, 1);
    nothing.mirrors = nothing.rims = {std::vector<double>(n), std::vector<double>(n * n), 0};
    const ImageModel model = calibrated->model.in_pixels();
    if (model.polarity != Polarity::dark || is_unusual_size(model.disc.diameter, scale) ||
        std::hypot(model.noise, kLeastMisfit * model.noise) > model.residual_rms) {
        return std::nullopt;
    }
    const CorrectionJudgement judgement =
        judge_correction(nothing, counts, model, options.detection, options.refinement, scale, 2);
    if (judgement.spheres < kLeastSpheres) return std::nullopt;
    return judgement.pattern;
}

/// Mean of the patterns and inverse of their covariance. A twentieth of each variance is added to
/// it: directions in which no camera differs say nothing.
PatternKind kind_of(const std::vector<ResidualPattern::Numbers>& all) {
    constexpr auto n = static_cast<Eigen::Index>(ResidualPattern::kNumbers);
    Eigen::MatrixXd patterns(static_cast<Eigen::Index>(all.size()), n);
    for (std::size_t k = 0; k < all.size(); ++k) {
        patterns.row(static_cast<Eigen::Index>(k)) =
            Eigen::Map<const Eigen::RowVectorXd>(all[k].data(), n);
    }
    const Eigen::RowVectorXd mean = patterns.colwise().mean();
    const Eigen::MatrixXd apart = patterns.rowwise() - mean;
    Eigen::MatrixXd covariance = apart.transpose() * apart / static_cast<double>(all.size() - 1);
    covariance.diagonal() *= 1.05;
    const Eigen::MatrixXd inverse = covariance.inverse();
    PatternKind kind;
    kind.mean.assign(mean.begin(), mean.end());
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) kind.weights.push_back(inverse(i, j));
    }
    kind.log_determinant = std::log(covariance.determinant());
    return kind;
}

using Numbers = ResidualPattern::Numbers;

/// The patterns of one kind, of all cameras but those of one fold.
std::vector<Numbers> gathered(const std::vector<CameraPatterns>& cameras,
                              std::optional<Numbers> CameraPatterns::*kind, std::size_t without) {
    std::vector<Numbers> all;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
        if (k % kFolds == without) continue;
        if (const auto& numbers = cameras[k].*kind) all.push_back(*numbers);
    }
    return all;
}

/// The fewest that are left without a fold.
std::size_t fewest(const std::vector<CameraPatterns>& cameras,
                   std::optional<Numbers> CameraPatterns::*kind) {
    std::size_t least = cameras.size();
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
        least = std::min(least, gathered(cameras, kind, fold).size());
    }
    return least;
}

}  // namespace

CameraPatterns patterns_of(const std::string& name, const Image& frame,
                           std::span<const Vec3> spheres, double scale, const TrackOptions& options,
                           RandomStream& random) {
    CameraPatterns patterns{.name = name};
    patterns.mirrors = pattern_of(frame, scale, options);
    patterns.rims = pattern_of(rimmed_discs(spheres, scale, frame.width(), frame.height(), random),
                               scale, options);
    return patterns;
}

void require_enough(const std::vector<CameraPatterns>& cameras) {
    const std::size_t mirrors = fewest(cameras, &CameraPatterns::mirrors);
    const std::size_t rims = fewest(cameras, &CameraPatterns::rims);
    if (mirrors >= kLeastPatterns && rims >= kLeastPatterns) return;
    throw InputError(
        {.problem = "too few patterns of mirrors or of discs with a rim",
         .actual = fmt::format("{} and {} from {} cameras, {} and {} without a fourth of them",
                               gathered(cameras, &CameraPatterns::mirrors, kFolds).size(),
                               gathered(cameras, &CameraPatterns::rims, kFolds).size(),
                               cameras.size(), mirrors, rims),
         .expected = fmt::format("{} of each, whichever fourth is left out", kLeastPatterns),
         .suggestion = fmt::format(
             "give folders of more scenes; a frame has a pattern where {} spheres or more are "
             "judged and discs leave {:g} of the noise or more",
             kLeastSpheres, kLeastMisfit)});
}

void describe_patterns(const std::vector<CameraPatterns>& cameras, std::size_t without,
                       GeneralCorrection& general) {
    general.mirrors = kind_of(gathered(cameras, &CameraPatterns::mirrors, without));
    general.rims = kind_of(gathered(cameras, &CameraPatterns::rims, without));
}

void print_patterns(const std::vector<CameraPatterns>& cameras) {
    std::vector<double> unlike, rims_unlike, odds, rims_odds;
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
        GeneralCorrection others;
        describe_patterns(cameras, fold, others);
        for (std::size_t k = fold; k < cameras.size(); k += kFolds) {
            if (const auto& p = cameras[k].mirrors) {
                unlike.push_back(others.unlikeness(*p));
                odds.push_back(others.log_odds(*p));
                if (odds.back() < 0) {
                    fmt::print("mirrors as discs with a rim: log odds {:.1f}, {}\n", odds.back(),
                               cameras[k].name);
                }
            }
            if (const auto& p = cameras[k].rims) {
                rims_unlike.push_back(others.unlikeness(*p));
                rims_odds.push_back(others.log_odds(*p));
            }
        }
    }
    const auto print = [](const char* what, const std::vector<double>& values) {
        fmt::print("{}: {} frames, from {:.2f} to {:.2f}, median {:.2f}\n", what, values.size(),
                   quantile(values, 0), quantile(values, 1), quantile(values, 0.5));
    };
    print("unlikeness of mirrors", unlike);
    print("unlikeness of discs with a rim", rims_unlike);
    print("log odds of mirrors", odds);
    print("log odds of discs with a rim", rims_odds);
}

}  // namespace grainfield::bench
