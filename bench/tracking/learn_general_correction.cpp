// Learns how discs err on mirror-like spheres from frames of many cameras (GeneralCorrection).
//
//   grainfield validate --optics random --scenes 20 --seed 101 --keep FRAMES -o page.html
//   grainfield validate --optics random --scenes 20 --seed 201 --crystals 1 --keep FRAMES …
//   bench.tracking.learn_general_correction general_correction.txt FRAMES…
//
// FRAMES: folders that `validate --keep` wrote: frame.png, true.csv and optics.toml of each scene.
// Each frame is calibrated and searched as `track` does it. What mirrors look like is learned from
// them, and what discs with a rim look like from frames of such discs in the same places
// (rimmed_discs). Every fourth camera is left out in
// turn: the table that is printed, the shares of the errors that remain, the doubt and the ridge
// are of cameras left out. The weights are of all.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "bench/tracking/rimmed_discs.h"
#include "core/frame_source.h"
#include "core/run_plan.h"
#include "core/support/random.h"
#include "io/frame_files.h"
#include "tests/support/csv_rows.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/film_model.h"
#include "tracking/locate.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/bias_terms.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/synthesis/general_correction.h"
#include "tracking/track_options.h"

namespace {

using namespace grainfield;
using namespace grainfield::tracking;
namespace fs = std::filesystem;

constexpr double kSame = 0.2;  // [a] a disc and its sphere
constexpr std::size_t kFolds = 4;
constexpr std::array<double, 4> kRidges = {1e-6, 1e-5, 1e-4, 1e-3};
constexpr Eigen::Index kTerms = BiasTerms::kCount;
constexpr Eigen::Index kAll = kTerms * static_cast<Eigen::Index>(GeneralCorrection::kFilmTerms);

/// One camera: rows are spheres along x, then along y.
struct Lesson {
    std::string name;
    double width = 0, diameter = 0;  ///< of the discs [a]
    Eigen::MatrixXf terms;
    Eigen::VectorXd lacks, error;  ///< truth − found, and its standard error [a]
    Eigen::VectorXd least;         ///< error that the noise of the camera alone makes [a]
    std::vector<std::size_t> overlap;
    std::optional<ResidualPattern::Numbers> mirrors = {}, rims = {};  ///< empty: pattern_of
};

double scale_in(const fs::path& file) {
    std::ifstream text(file);
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with("scale = ")) return std::stod(line.substr(8));
    }
    throw std::invalid_argument("no scale in " + file.string());
}

constexpr int kLeastSpheres = 100;
/// Less beside the noise is no misfit to learn a pattern from.
constexpr double kLeastMisfit = 0.5;

/// By pixels, as judge_correction sees it. Empty: the frame cannot be calibrated, holds fewer than
/// kLeastSpheres, its discs have an unusual size, or they leave less than kLeastMisfit of the noise
/// of a pixel. Blocks have less noise, so that `track` judges some frames more.
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

/// Empty: the frame cannot be calibrated, or no sphere of it was found.
std::optional<Lesson> lesson_of(const fs::path& scene, std::uint64_t number) {
    const double scale = scale_in(scene / "optics.toml");
    auto source = io::open_frames({scene / "frame.png"}, {});
    TrackOptions options;
    options.sphere_diameter = scale;
    options.correct_bias = false;
    // As films of mirrors are seen (model_of_film); here whatever a first fit leaves.
    options.binning = mirror_blocks(scale);
    options.detection = detection_of(options);
    RunPlan plan;
    const FilmModel film = model_of_film(*source, options, 2, plan);
    if (!film.film.calibration) return std::nullopt;
    const ImageModel& model = film.film.calibration->model;
    // From here on in blocks.
    const Binning blocks = model.binning;
    const double a = scale / blocks.factor;
    std::vector<Vec3> spheres;
    std::vector<Vec2> truth;
    for (auto& row : grainfield::testing::csv_rows(scene / "true.csv")) {
        const Vec3 p{std::stod(row["x"]), std::stod(row["y"]), std::stod(row["z"])};
        spheres.push_back(p);
        truth.push_back(blocks.in_blocks(Vec2{p.x, p.y}));
    }
    const Image frame = source->read(0).image;
    const Image counts = blocks.binned(frame);
    const Image darkness = model.darkness(counts);
    Locator locator(counts.width(), counts.height(), model, 2);
    locator.expect_misfit(model.residual_rms);
    const Located found = locator.locate(darkness, in_blocks(options.detection, blocks),
                                         in_blocks(options.refinement, blocks));
    const Image residual = locator.residual();
    const std::vector<Vec2> errors = standard_errors(found);
    const BiasTerms terms(darkness, residual, found.fitted, a);
    const PointGrid grid(truth, kSame * a);
    std::vector<BiasTerms::Terms> rows;
    std::vector<Vec2> lacks;
    std::vector<Vec2> expected;
    std::vector<Vec2> least_expected;
    Lesson lesson{.name = scene.string(),
                  .width = model.disc.edge_width / a,
                  .diameter = model.disc.diameter / a,
                  .terms = {},
                  .lacks = {},
                  .error = {},
                  .least = {},
                  .overlap = {}};
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        const double inside =
            std::min({p.x, p.y, counts.width() - 1 - p.x, counts.height() - 1 - p.y});
        if (inside < BiasTerms::kReach * a) continue;
        if (!std::isfinite(squared_norm(errors[i])) || !(errors[i].x > 0 && errors[i].y > 0)) {
            continue;
        }
        double least = kSame * kSame * a * a;
        std::optional<Vec2> lack;
        grid.near(p, kSame * a, [&](std::uint32_t, Vec2 q) {
            if (squared_norm(q - p) >= least) return;
            least = squared_norm(q - p);
            lack = (1 / a) * (q - p);
        });
        if (!lack) continue;
        rows.push_back(terms.of(p));
        lacks.push_back(*lack);
        expected.push_back((1 / a) * errors[i]);
        least_expected.push_back((found.noise / a) * found.error[i]);
        lesson.overlap.push_back(overlap_class(terms.nearest(p)));
    }
    if (rows.empty()) return std::nullopt;
    lesson.mirrors = pattern_of(frame, scale, options);
    RandomStream random(number, "discs with a rim");
    lesson.rims = pattern_of(
        bench::rimmed_discs(spheres, scale, frame.width(), frame.height(), random), scale, options);
    const auto n = static_cast<Eigen::Index>(rows.size());
    lesson.terms.resize(2 * n, kTerms);
    lesson.lacks.resize(2 * n);
    lesson.error.resize(2 * n);
    lesson.least.resize(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        lesson.terms.row(i) = Eigen::Map<const Eigen::RowVectorXf>(rows[k].x.data(), kTerms);
        lesson.terms.row(n + i) = Eigen::Map<const Eigen::RowVectorXf>(rows[k].y.data(), kTerms);
        lesson.lacks(i) = lacks[k].x;
        lesson.lacks(n + i) = lacks[k].y;
        lesson.error(i) = expected[k].x;
        lesson.error(n + i) = expected[k].y;
        lesson.least(i) = least_expected[k].x;
        lesson.least(n + i) = least_expected[k].y;
    }
    return lesson;
}

/// Sums over cameras. Within one camera what a weight depends on is one number, so that the sums
/// over its terms are made once.
struct Sums {
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kAll, kAll);
    Eigen::VectorXd product = Eigen::VectorXd::Zero(kAll);
    double rows = 0;

    void add(const Lesson& lesson) {
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

Eigen::VectorXd shift_by(const Eigen::VectorXd& weights, const Lesson& lesson) {
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

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    const auto place = values.begin() +
                       static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

/// A corrected position of a camera left out, along one axis [a].
struct Corrected {
    double left = 0;   ///< its error, without sign
    double error = 0;  ///< standard error of the disc
    double least = 0;  ///< that the noise of the camera alone makes
    double shift = 0;  ///< by the correction, without sign
    std::size_t overlap = 0;

    double sigma(const GeneralCorrection& general) const {
        return std::hypot(std::max(general.shares[overlap] * error, least), general.doubt * shift);
    }
};

double share_within(const std::vector<const Corrected*>& positions,
                    const GeneralCorrection& general) {
    std::size_t within = 0;
    for (const Corrected* c : positions) within += c->left <= 2 * c->sigma(general);
    return static_cast<double>(within) / static_cast<double>(positions.size());
}

constexpr double kWithin = 0.954;

/// `shares` with which, for a given doubt, 95.4 % of each class of overlap lie within two standard
/// errors. Every sphere counts alike.
void find_shares(const std::vector<std::vector<const Corrected*>>& by_overlap,
                 GeneralCorrection& general) {
    general.shares.assign(kOverlapClasses, 1);
    for (std::size_t overlap = 0; overlap < by_overlap.size(); ++overlap) {
        if (by_overlap[overlap].empty()) continue;
        double low = 0;
        double high = 1;
        for (int halving = 0; halving < 14; ++halving) {
            double& share = general.shares[overlap];
            share = 0.5 * (low + high);
            (share_within(by_overlap[overlap], general) < kWithin ? low : high) = share;
        }
    }
}

/// The doubt with which the tenths of all positions by shift/error have the most even share within
/// two standard errors, and its shares.
void find_errors(const std::vector<Corrected>& positions, GeneralCorrection& general) {
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
    GeneralCorrection tried;
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
        general.doubt = tried.doubt;
        general.shares = tried.shares;
    }
}

/// Mean of the patterns and inverse of their covariance. A twentieth of each variance is added to
/// it: directions in which no camera differs say nothing.
PatternKind kind_of(const std::vector<ResidualPattern::Numbers>& all) {
    constexpr auto n = static_cast<Eigen::Index>(ResidualPattern::kNumbers);
    if (all.size() < 2 * ResidualPattern::kNumbers) throw std::invalid_argument("too few patterns");
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

/// Of all lessons but those of one fold; kFolds: of all.
void describe_patterns(const std::vector<Lesson>& lessons, std::size_t without,
                       GeneralCorrection& general) {
    std::vector<ResidualPattern::Numbers> mirrors;
    std::vector<ResidualPattern::Numbers> rims;
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        if (k % kFolds == without) continue;
        if (lessons[k].mirrors) mirrors.push_back(*lessons[k].mirrors);
        if (lessons[k].rims) rims.push_back(*lessons[k].rims);
    }
    general.mirrors = kind_of(mirrors);
    general.rims = kind_of(rims);
}

/// How well cameras left out are told apart.
void print_patterns(const std::vector<Lesson>& lessons) {
    std::vector<double> unlike, rims_unlike, odds, rims_odds;
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
        GeneralCorrection others;
        describe_patterns(lessons, fold, others);
        for (std::size_t k = fold; k < lessons.size(); k += kFolds) {
            if (const auto& p = lessons[k].mirrors) {
                unlike.push_back(others.unlikeness(*p));
                odds.push_back(others.log_odds(*p));
                if (odds.back() < 0) {
                    fmt::print("mirrors as discs with a rim: log odds {:.1f}, {}\n", odds.back(),
                               lessons[k].name);
                }
            }
            if (const auto& p = lessons[k].rims) {
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

std::vector<Lesson> lessons_in(const std::vector<std::string>& folders) {
    std::vector<Lesson> lessons;
    for (const std::string& folder : folders) {
        std::vector<fs::path> scenes;
        for (const auto& entry : fs::directory_iterator(folder)) scenes.push_back(entry.path());
        std::sort(scenes.begin(), scenes.end());
        for (const fs::path& scene : scenes) {
            std::optional<Lesson> lesson = lesson_of(scene, lessons.size());
            if (!lesson) {
                fmt::print(stderr, "nothing to learn from in {}\n", scene.string());
                continue;
            }
            fmt::print(stderr, "\r{} cameras", lessons.size() + 1);
            lessons.push_back(std::move(*lesson));
        }
    }
    fmt::print(stderr, "\n");
    return lessons;
}

void learn(const std::string& output, const std::vector<std::string>& folders) {
    const std::vector<Lesson> lessons = lessons_in(folders);
    if (lessons.size() < 2 * kFolds) throw std::invalid_argument("too few cameras");
    std::vector<Sums> sums(kFolds);
    for (std::size_t k = 0; k < lessons.size(); ++k) sums[k % kFolds].add(lessons[k]);
    Sums all;
    for (const Sums& fold : sums) {
        all.squares += fold.squares;
        all.product += fold.product;
        all.rows += fold.rows;
    }
    double least = 0;
    double chosen = 0;
    std::vector<Eigen::VectorXd> best;  // what positions of cameras left out still lack
    std::vector<Eigen::VectorXd> shifts;
    for (const double ridge : kRidges) {
        std::vector<Eigen::VectorXd> left(lessons.size());
        std::vector<Eigen::VectorXd> shift(lessons.size());
        double sum = 0;
        for (std::size_t fold = 0; fold < kFolds; ++fold) {
            const Sums others{all.squares - sums[fold].squares, all.product - sums[fold].product,
                              all.rows - sums[fold].rows};
            const Eigen::VectorXd weights = weights_of(others, ridge);
            for (std::size_t k = fold; k < lessons.size(); k += kFolds) {
                shift[k] = shift_by(weights, lessons[k]);
                left[k] = lessons[k].lacks - shift[k];
                sum += std::log(rms(left[k]));  // every camera counts alike
            }
        }
        fmt::print(stderr, "ridge {:g}: {:.5f} a, geometric mean\n", ridge,
                   std::exp(sum / static_cast<double>(lessons.size())));
        if (!best.empty() && sum >= least) continue;
        least = sum;
        chosen = ridge;
        best = std::move(left);
        shifts = std::move(shift);
    }
    GeneralCorrection general;
    std::vector<std::vector<Corrected>> corrected;
    std::vector<Corrected> of_all;
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        const std::size_t n = lessons[k].overlap.size();
        auto& of_camera = corrected.emplace_back();
        for (std::size_t i = 0; i < 2 * n; ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            of_camera.push_back({.left = std::abs(best[k](row)),
                                 .error = lessons[k].error(row),
                                 .least = lessons[k].least(row),
                                 .shift = std::abs(shifts[k](row)),
                                 .overlap = lessons[k].overlap[i % n]});
        }
        of_all.insert(of_all.end(), of_camera.begin(), of_camera.end());
    }
    find_errors(of_all, general);
    std::vector<double> before;
    std::vector<double> after;
    std::vector<double> widths;
    std::vector<double> diameters;
    fmt::print("camera | spheres | w [a] | D [a] | rms of discs [a] | corrected | within 2σ\n");
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        const Lesson& lesson = lessons[k];
        const std::size_t n = lesson.overlap.size();
        int within = 0;
        for (const Corrected& c : corrected[k]) within += c.left <= 2 * c.sigma(general);
        before.push_back(rms(lesson.lacks));
        after.push_back(rms(best[k]));
        widths.push_back(lesson.width);
        diameters.push_back(lesson.diameter);
        general.spheres += static_cast<int>(n);
        fmt::print("{} | {} | {:.3f} | {:.3f} | {:.4f} | {:.4f} | {:.3f}\n", lesson.name, n,
                   lesson.width, lesson.diameter, before.back(), after.back(),
                   within / (2.0 * static_cast<double>(n)));
    }
    general.cameras = static_cast<int>(lessons.size());
    general.before = quantile(before, 0.5);
    general.after = quantile(after, 0.5);
    general.least_width = *std::min_element(widths.begin(), widths.end());
    general.most_width = *std::max_element(widths.begin(), widths.end());
    general.least_diameter = *std::min_element(diameters.begin(), diameters.end());
    general.most_diameter = *std::max_element(diameters.begin(), diameters.end());
    describe_patterns(lessons, kFolds, general);
    print_patterns(lessons);
    const Eigen::VectorXd weights = weights_of(all, chosen);
    for (Eigen::Index k = 0; k < kTerms; ++k) {
        general.weights.push_back({weights(k), weights(kTerms + k), weights(2 * kTerms + k)});
    }
    std::ofstream file(output);
    file << write_general_correction(general) << std::flush;
    if (!file) throw std::runtime_error("cannot write " + output);
    fmt::print("{} cameras: median {:.4f} to {:.4f} a; ridge {:g}\n", lessons.size(),
               general.before, general.after, chosen);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc < 3) throw std::invalid_argument("give an output file and folders of scenes");
        learn(argv[1], {argv + 2, argv + argc});
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
