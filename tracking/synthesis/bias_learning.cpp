#include "tracking/synthesis/bias_learning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "core/support/interrupt.h"
#include "core/support/parallel.h"
#include "core/support/random.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/bias_terms.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/synthesis/random_moves.h"
#include "tracking/synthesis/rendered_part.h"

namespace grainfield::tracking {
namespace {

constexpr double kMargin = 2;       // [a] from its border: what lies beyond is not rendered
constexpr double kSame = 0.2;       // [a] a disc and its sphere
constexpr double kMoveStep = 0.06;  // [a]
constexpr int kMoveSweeps = 60;
constexpr double kStartStep = 0.03;       // [a] RMS per axis of the discs before the fit
constexpr double kSeen = 0.4;             // [a] beyond the border, where a sphere is still seen
constexpr double kExplainedBetter = 0.6;  // of the misfit of discs may remain
constexpr double kLeastGain = 0.9;        // of the error may remain
constexpr double kMostUnlike = 1.25;      // corrections of the frame to those of rendered ones
constexpr int kLeastSpheres = 500;
constexpr std::array<double, 5> kRidges = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2};

double beyond_noise(double rms, double noise) {
    return std::sqrt(std::max(0.0, rms * rms - noise * noise));
}

/// One frame of known truth, tracked.
struct Lesson {
    Eigen::MatrixXf terms;  ///< a row an axis and sphere
    Eigen::VectorXf lacks;  ///< truth − found [a]
    std::vector<double> nearest, residual;
    std::size_t part = 0;
    std::size_t fold = 0;  ///< lessons that are left out together
};

/// Sums over the lessons of a fold.
struct Sums {
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(BiasTerms::kCount, BiasTerms::kCount);
    Eigen::VectorXd product = Eigen::VectorXd::Zero(BiasTerms::kCount);
    double rows = 0;
};

std::vector<Sums> sums_of(const std::vector<Lesson>& lessons, std::size_t folds, int threads) {
    std::vector<Sums> sums(folds);
    parallel_for(static_cast<std::int64_t>(folds), threads, [&](std::int64_t index) {
        const auto fold = static_cast<std::size_t>(index);
        for (const Lesson& lesson : lessons) {
            if (lesson.fold != fold || lesson.lacks.size() == 0) continue;
            const Eigen::MatrixXd exact = lesson.terms.cast<double>();
            sums[fold].squares.selfadjointView<Eigen::Lower>().rankUpdate(exact.transpose());
            sums[fold].product += exact.transpose() * lesson.lacks.cast<double>();
            sums[fold].rows += static_cast<double>(lesson.lacks.size());
        }
    });
    return sums;
}

Lesson lesson_of(const Image& darkness, const std::vector<Point3>& spheres, const ImageModel& model,
                 const BiasSetting& setting, std::uint64_t index) {
    const double a = setting.diameter;
    Locator locator(darkness.width(), darkness.height(), model, 1);
    locator.expect_misfit(model.residual_rms);
    // As from the frame before: a cold search of a part may end in another arrangement.
    RandomStream random(setting.seed, "start", index);
    std::vector<Vec2> truth;
    std::vector<Vec2> start;
    for (const Point3& p : spheres) {
        const Vec2 q{static_cast<double>(p.x) * a, static_cast<double>(p.y) * a};
        truth.push_back(q);
        const double x = q.x + kStartStep * a * random.normal();
        const double y = q.y + kStartStep * a * random.normal();
        const double beyond =
            std::max({-q.x, -q.y, q.x - (darkness.width() - 1), q.y - (darkness.height() - 1)});
        if (beyond < kSeen * a) start.push_back({x, y});
    }
    const Located found =
        locator.locate(darkness, setting.detection, setting.refinement, start, kStartStep * a);
    const Image residual = locator.residual();
    const BiasTerms terms(darkness, residual, found.fitted, a);
    const double range = kSame * a;
    Lesson lesson;
    std::vector<std::size_t> used;
    std::vector<Vec2> lacks;
    const PointGrid grid(truth, range);
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        if (std::min({p.x, p.y, darkness.width() - 1 - p.x, darkness.height() - 1 - p.y}) <
            kMargin * a) {
            continue;
        }
        double least = range * range;
        Vec2 lack{0, 0};
        grid.near(p, range, [&](std::uint32_t, Vec2 q) {
            if (squared_norm(q - p) >= least) return;
            least = squared_norm(q - p);
            lack = q - p;
        });
        if (least >= range * range) continue;  // no sphere is there
        used.push_back(i);
        lacks.push_back((1 / a) * lack);
    }
    const auto rows = static_cast<Eigen::Index>(2 * used.size());
    lesson.terms.resize(rows, BiasTerms::kCount);
    lesson.lacks.resize(rows);
    for (std::size_t k = 0; k < used.size(); ++k) {
        const Vec2 p = found.position[used[k]];
        const BiasTerms::Terms t = terms.of(p);
        const auto row = static_cast<Eigen::Index>(2 * k);
        lesson.terms.row(row) = Eigen::Map<const Eigen::RowVectorXf>(t.x.data(), BiasTerms::kCount);
        lesson.terms.row(row + 1) =
            Eigen::Map<const Eigen::RowVectorXf>(t.y.data(), BiasTerms::kCount);
        lesson.lacks(row) = static_cast<float>(lacks[k].x);
        lesson.lacks(row + 1) = static_cast<float>(lacks[k].y);
        lesson.nearest.push_back(terms.nearest(p));
        lesson.residual.push_back(found.residual[used[k]]);
    }
    return lesson;
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Weights of the terms; `without`: the fold that is left out, or kNone.
Eigen::VectorXd weights_of(const std::vector<Sums>& sums, std::size_t without, double ridge) {
    Sums all;
    for (std::size_t k = 0; k < sums.size(); ++k) {
        if (k == without) continue;
        all.squares += sums[k].squares;
        all.product += sums[k].product;
        all.rows += sums[k].rows;
    }
    auto& [squares, product, rows] = all;
    // In units of their own RMS all terms are shrunk alike.
    const Eigen::VectorXd scale =
        (squares.diagonal().array() / rows + 1e-24).sqrt().inverse().matrix();
    squares = (scale.asDiagonal() * squares * scale.asDiagonal()).eval();
    squares.diagonal().array() += ridge * rows;
    const Eigen::VectorXd solved =
        squares.selfadjointView<Eigen::Lower>().llt().solve(scale.asDiagonal() * product);
    return scale.asDiagonal() * solved;
}

/// RMS and median of absolute values [a].
struct Spread {
    double rms = 0, median = 0;
};

Spread spread_of(std::vector<double> errors) {
    if (errors.empty()) return {};
    Spread spread;
    for (double& e : errors) {
        spread.rms += e * e;
        e = std::abs(e);
    }
    spread.rms = std::sqrt(spread.rms / static_cast<double>(errors.size()));
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    spread.median = *middle;
    return spread;
}

Spread spread_of(const std::vector<Eigen::VectorXd>& errors) {
    std::vector<double> all;
    for (const Eigen::VectorXd& e : errors) all.insert(all.end(), e.begin(), e.end());
    return spread_of(std::move(all));
}

/// Bounds of residual classes of equal numbers.
std::vector<double> bounds_of(const std::vector<Lesson>& lessons) {
    std::vector<double> all;
    for (const Lesson& lesson : lessons) {
        all.insert(all.end(), lesson.residual.begin(), lesson.residual.end());
    }
    std::sort(all.begin(), all.end());
    std::vector<double> bounds;
    for (std::size_t k = 1; k < kQualityClasses; ++k) {
        bounds.push_back(all[all.size() * k / kQualityClasses]);
    }
    return bounds;
}

/// RMS of the errors left out, by class. A class of few takes the mean of all into account.
std::vector<double> remaining_of(const std::vector<Lesson>& lessons,
                                 const std::vector<Eigen::VectorXd>& errors,
                                 const BiasCorrection& correction) {
    constexpr double kOfAll = 20;  // values
    constexpr std::size_t kClasses = std::size_t{kOverlapClasses} * kQualityClasses;
    std::vector<double> sum(kClasses, kOfAll * correction.after * correction.after);
    std::vector<double> n(kClasses, kOfAll);
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        for (std::size_t i = 0; i < lessons[k].nearest.size(); ++i) {
            const std::size_t kind =
                class_of(correction, lessons[k].nearest[i], lessons[k].residual[i]);
            sum[kind] += errors[k].segment<2>(static_cast<Eigen::Index>(2 * i)).squaredNorm();
            n[kind] += 2;
        }
    }
    for (std::size_t c = 0; c < kClasses; ++c) sum[c] = std::sqrt(sum[c] / n[c]);
    return sum;
}

/// Weights, and what they leave on frames that had no part in them.
struct Regression {
    BiasCorrection correction;
    std::vector<Eigen::VectorXd> plain, left;  ///< errors of the lessons, held out [a]
};

Regression regression(const std::vector<Lesson>& lessons, std::size_t folds, int threads) {
    Regression best;
    BiasCorrection& correction = best.correction;
    const std::vector<Sums> sums = sums_of(lessons, folds, threads);
    double chosen = 0;
    for (const double ridge : kRidges) {
        std::vector<Eigen::VectorXd> errors(lessons.size());
        parallel_for(static_cast<std::int64_t>(folds), threads, [&](std::int64_t index) {
            const auto fold = static_cast<std::size_t>(index);
            const Eigen::VectorXd weights = weights_of(sums, fold, ridge);
            for (std::size_t k = 0; k < lessons.size(); ++k) {
                if (lessons[k].fold != fold) continue;
                errors[k] =
                    lessons[k].lacks.cast<double>() - lessons[k].terms.cast<double>() * weights;
            }
        });
        const double rms = spread_of(errors).rms;
        if (!best.left.empty() && rms >= correction.after) continue;
        correction.after = rms;
        best.left = std::move(errors);
        chosen = ridge;
    }
    const Eigen::VectorXd weights = weights_of(sums, kNone, chosen);
    correction.weights.assign(weights.begin(), weights.end());
    for (const Lesson& lesson : lessons) best.plain.push_back(lesson.lacks.cast<double>());
    correction.before = spread_of(best.plain).rms;
    correction.quality = bounds_of(lessons);
    correction.remaining = remaining_of(lessons, best.left, correction);
    return best;
}

/// Why the held-out frames do not show that it helps; empty: they do.
std::string refused_by_held_out(const std::vector<Lesson>& lessons, const Regression& found,
                                std::size_t parts) {
    const Spread before = spread_of(found.plain);
    const Spread after = spread_of(found.left);
    if (after.rms > kLeastGain * before.rms || after.median > kLeastGain * before.median) {
        return fmt::format(
            "held-out frames gain too little, {:.4f} to {:.4f} a RMS, median {:.4f} to {:.4f}",
            before.rms, after.rms, before.median, after.median);
    }
    for (std::size_t part = 0; part < parts; ++part) {
        std::vector<Eigen::VectorXd> plain;
        std::vector<Eigen::VectorXd> left;
        for (std::size_t k = 0; k < lessons.size(); ++k) {
            if (lessons[k].part != part) continue;
            plain.push_back(found.plain[k]);
            left.push_back(found.left[k]);
        }
        const Spread here = spread_of(plain);
        const Spread then = spread_of(left);
        if (then.rms > here.rms || then.median > here.median) {
            return fmt::format(
                "in a part of the frame held-out errors grow, {:.4f} to {:.4f} a RMS, median "
                "{:.4f} to {:.4f}",
                here.rms, then.rms, here.median, then.median);
        }
    }
    return "";
}

/// What a rendering of the frame leaves beyond that of the fitted spheres, squares.
struct Excess {
    double discs = 0, corrected = 0;
};

/// Spheres near the border, and those that no disc of `found` is near, stay where they are.
Excess excess_of(const FramePart& part, const RenderedPart& rendered, const Located& found,
                 const Located& corrected, double diameter, int threads) {
    const double range = kSame * diameter;
    const PointGrid grid(found.position, range);
    std::vector<Vec2> discs;
    std::vector<Vec2> moved;
    for (const Point3& p : rendered.spheres) {
        const Vec2 fitted{part.x0 + static_cast<double>(p.x) * diameter,
                          part.y0 + static_cast<double>(p.y) * diameter};
        double least = part.inside(fitted) < kMargin * diameter ? 0 : range * range;
        Vec2 disc = fitted;
        Vec2 place = fitted;
        grid.near(fitted, range, [&](std::uint32_t i, Vec2 q) {
            if (squared_norm(q - fitted) >= least) return;
            least = squared_norm(q - fitted);
            disc = q;
            place = corrected.position[i];
        });
        discs.push_back(disc);
        moved.push_back(place);
    }
    const double best = rendered.rms * rendered.rms;
    const double of_discs = rms_at(discs, rendered, part, diameter, threads);
    const double of_moved = rms_at(moved, rendered, part, diameter, threads);
    return {std::max(0.0, of_discs * of_discs - best), std::max(0.0, of_moved * of_moved - best)};
}

/// Why the frame itself does not show that it helps; empty: it does.
std::string refused_by_frame(const std::vector<FramePart>& parts,
                             const std::vector<RenderedPart>& rendered, const Located& found,
                             const Located& corrected, double diameter, int threads) {
    Excess all;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Excess here = excess_of(parts[p], rendered[p], found, corrected, diameter, threads);
        if (here.corrected > here.discs) {
            return fmt::format(
                "in a part of the frame it does not suit the image: its renderings leave {:.4f} of "
                "the contrast beyond the best, those of discs {:.4f}",
                std::sqrt(here.corrected), std::sqrt(here.discs));
        }
        all.discs += here.discs / static_cast<double>(parts.size());
        all.corrected += here.corrected / static_cast<double>(parts.size());
    }
    if (all.corrected > kLeastGain * kLeastGain * all.discs) {
        return fmt::format(
            "the image shows too little gain: renderings leave {:.4f} of the contrast beyond the "
            "best, those of discs {:.4f}",
            std::sqrt(all.corrected), std::sqrt(all.discs));
    }
    return "";
}

/// Why the frame is not like the rendered ones; empty: it is.
std::string refused_as_unlike(const std::vector<FramePart>& parts,
                              const std::vector<Lesson>& lessons, const BiasCorrection& correction,
                              const Located& found, const Located& corrected, double diameter) {
    const Eigen::VectorXd weights =
        Eigen::Map<const Eigen::VectorXd>(correction.weights.data(), BiasTerms::kCount);
    std::vector<Eigen::VectorXd> of_rendered;
    for (const Lesson& lesson : lessons) {
        of_rendered.push_back(lesson.terms.cast<double>() * weights);
    }
    std::vector<double> of_frame;
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 q = found.position[i];
        for (const FramePart& part : parts) {
            if (part.inside(q) < kMargin * diameter) continue;
            const Vec2 off = (1 / diameter) * (corrected.position[i] - q);
            of_frame.insert(of_frame.end(), {off.x, off.y});
        }
    }
    const double here = spread_of(of_frame).rms;
    const double there = spread_of(of_rendered).rms;
    if (here <= kMostUnlike * there) return "";
    return fmt::format(
        "positions of the frame would move by {:.4f} a RMS, those of rendered frames by {:.4f}",
        here, there);
}

}  // namespace

BiasLearning learn_bias(const Image& counts, const ImageModel& model, const BiasSetting& setting,
                        int threads) {
    const double a = setting.diameter;
    BiasLearning learned;
    Locator locator(counts.width(), counts.height(), model, threads);
    locator.expect_misfit(model.residual_rms);
    const Image darkness = model.darkness(counts);
    const Located found = locator.locate(darkness, setting.detection, setting.refinement);
    if (found.fitted.empty()) {
        learned.refused = "no spheres were found";
        return learned;
    }
    const RenderSetting render{.diameter = a,
                               .height = setting.height,
                               .camera_distance = setting.camera_distance,
                               .frame_width = static_cast<double>(counts.width()),
                               .frame_height = static_cast<double>(counts.height())};
    std::vector<FramePart> parts;
    std::vector<RenderedPart> rendered;
    double misfit = 0;
    std::vector<FramePart> wanted = parts_of(counts, model, setting.part * a);
    Progress fitting("fitting mirror spheres", static_cast<std::int64_t>(wanted.size()),
                     "parts of the frame", setting.verbosity);
    fitting.announce();
    for (FramePart& part : wanted) {
        RenderedPart fitted = fitted_part(part, model, found.fitted, render, threads);
        fitting.advance();
        throw_if_interrupted("tracking");
        if (fitted.spheres.empty()) continue;
        misfit += fitted.rms * fitted.rms;
        parts.push_back(std::move(part));
        rendered.push_back(std::move(fitted));
    }
    fitting.finish();
    if (parts.empty()) {
        learned.refused = "no spheres were found where frames are rendered";
        return learned;
    }
    learned.parts = static_cast<int>(parts.size());
    learned.mirror_misfit =
        beyond_noise(std::sqrt(misfit / static_cast<double>(parts.size())), model.noise);
    learned.disc_misfit = beyond_noise(found.residual_rms, model.noise);
    if (learned.mirror_misfit > kExplainedBetter * learned.disc_misfit) {
        learned.refused = fmt::format(
            "mirror spheres leave {:.3f} of the contrast beyond the noise, discs {:.3f}",
            learned.mirror_misfit, learned.disc_misfit);
        return learned;
    }
    // Where the parts are many, fewer frames of each do.
    const auto folds = static_cast<std::size_t>(parts.size() > 1 ? std::max(2, setting.frames / 2)
                                                                 : setting.frames);
    std::vector<Lesson> lessons(parts.size() * folds);
    Progress learning("learning how discs err", static_cast<std::int64_t>(lessons.size()),
                      "renderings", setting.verbosity);
    std::mutex one_at_a_time;
    parallel_for(static_cast<std::int64_t>(lessons.size()), threads, [&](std::int64_t index) {
        const auto k = static_cast<std::size_t>(index);
        const std::size_t p = k / folds;
        const auto stream = static_cast<std::uint64_t>(index);
        const std::vector<Point3> moved = moved_at_random(
            rendered[p].spheres, setting.height - 1, kMoveStep, kMoveSweeps, setting.seed, stream);
        const Image seen =
            frame_of(moved, rendered[p], parts[p], a, model.noise, setting.seed, stream);
        lessons[k] = lesson_of(seen, moved, model, setting, stream);
        lessons[k].part = p;
        lessons[k].fold = k % folds;
        const std::lock_guard lock(one_at_a_time);
        learning.advance();
    });
    learning.finish();
    throw_if_interrupted("tracking");
    learned.frames = static_cast<int>(lessons.size());
    for (const Lesson& lesson : lessons) {
        learned.spheres += static_cast<int>(lesson.nearest.size());
    }
    if (learned.spheres < kLeastSpheres) {
        learned.refused =
            fmt::format("{} spheres lie {:g} a or more within the rendered parts, {} are needed",
                        learned.spheres, kMargin, kLeastSpheres);
        return learned;
    }
    const Regression outcome = regression(lessons, folds, threads);
    learned.correction = outcome.correction;
    learned.refused = refused_by_held_out(lessons, outcome, parts.size());
    if (!learned.refused.empty()) return learned;
    // What is learned holds for frames of the same kind.
    Located corrected = found;
    learned.correction.diameter = setting.diameter;
    learned.correction.height = setting.height;
    learned.correction.camera_distance = setting.camera_distance;
    correct_bias(learned.correction, darkness, locator.residual(), a, corrected, threads);
    learned.refused = refused_as_unlike(parts, lessons, learned.correction, found, corrected, a);
    if (learned.refused.empty()) {
        learned.refused = refused_by_frame(parts, rendered, found, corrected, a, threads);
    }
    return learned;
}

}  // namespace grainfield::tracking
