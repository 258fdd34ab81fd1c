#include "tracking/locate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tracking/detect/distance_transform.h"
#include "tracking/model/product_image.h"
#include "tracking/refine/joint_covariance.h"

namespace grainfield::tracking {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

int rows_of_blocks(int height, int factor, int spacing) {
    return (height / factor - 1) / spacing + 1;
}

/// The mean over whole blocks of factor × factor pixels, of every spacing-th row of them; what is
/// left at the right and lower border is left out.
void reduce(const PaddedImage& image, int factor, int spacing, int threads, Image& result) {
    const int width = image.width() / factor;
    const int height = rows_of_blocks(image.height(), factor, spacing);
    if (result.width() != width || result.height() != height) result = Image(width, height);
    const float share = 1.0F / static_cast<float>(factor * factor);
    in_row_bands(image.width(), height, threads, [&](int first, int last) {
        std::vector<float> sums(static_cast<std::size_t>(image.width()));
        for (int y = first; y < last; ++y) {
            const int top = y * spacing * factor;
            std::copy_n(image.row(top), image.width(), sums.data());
            for (int v = 1; v < factor; ++v) {
                const float* row = image.row(top + v);
                for (int x = 0; x < image.width(); ++x) sums[static_cast<std::size_t>(x)] += row[x];
            }
            float* out = result.row(y);
            const float* in = sums.data();
            for (int x = 0; x < width; ++x, in += factor) {
                float sum = in[0];
                for (int u = 1; u < factor; ++u) sum += in[u];
                out[x] = sum * share;
            }
        }
    });
}

/// A disc in blocks. The derivative of its edge, sech², has variance π²w²/12; averaging over blocks
/// adds factor²/12.
DiscProfile reduced(const DiscProfile& disc, int factor) {
    const double blur = factor / std::numbers::pi;
    return {disc.diameter / factor, std::hypot(disc.edge_width, blur) / factor, disc.shape};
}

// As far as this one joint step is as good as any number of single ones: for an isolated disc the
// error is of third order, for overlapping ones of second order in the step.
constexpr double kNewton = 0.08;      // [w]
constexpr double kLeastError = 1e-4;  // [px]
constexpr double kSwept = 0.03;       // [w]
constexpr int kMostSettling = 4;
// What is updated after a round keeps the couplings of before. Where many have gone far in a
// crystal the matrix is then no longer positive, and joint steps diverge.
constexpr double kMostFar = 0.28;  // of all discs
// A step of less than this many standard errors of an isolated sphere is not drawn.
constexpr double kUndrawn = 8;
// The image that the product should see is made for the positions of the fit before; in crystals
// the first correction moves some spheres far.
constexpr int kCorrections = 2;
constexpr double kFarthest = 0.3;   // [D]
constexpr double kMostWrong = 0.2;  // of the image

/// Sweeps end where one joint step does the rest.
RefinementOptions swept(const RefinementOptions& refinement, const DiscProfile& disc) {
    RefinementOptions sweeps = refinement;
    sweeps.tolerance = std::max(refinement.tolerance, kSwept * disc.edge_width);
    return sweeps;
}

/// Rough rounds stop early: positions only need to be good enough to judge the residual.
RefinementOptions rough_version(const RefinementOptions& refinement, const DiscProfile& disc) {
    RefinementOptions rough = swept(refinement, disc);
    rough.max_sweeps = std::min(refinement.max_sweeps, 4);
    return rough;
}

}  // namespace

Locator::Locator(int width, int height, DiscModel model, int threads)
    : model_(std::move(model)),
      factor_(DiscCorrelation::suitable_factor(model_.disc)),
      threads_(threads),
      correlation_(width, height, model_.disc, factor_),
      fit_(Image(width, height), model_.disc, threads) {
    if (factor_ > 1 && width >= 2 * factor_ && height >= 2 * factor_) {
        const DiscProfile blocks = reduced(model_.disc, factor_);
        coarse_.emplace(width / factor_, height / factor_, blocks, 1);
        coarse_fit_.emplace(Image(width / factor_, height / factor_), blocks, threads);
        approach_.emplace(Image(width / factor_, rows_of_blocks(height, factor_, kApproachSpacing)),
                          blocks, threads, kApproachSpacing);
    }
}

void Locator::set_threads(int threads) {
    threads_ = threads;
    fit_.set_threads(threads);
    if (!coarse_) return;
    coarse_fit_->set_threads(threads);
    approach_->set_threads(threads);
}

void Locator::set_visible(const VisiblePixels& visible) {
    if (visible.are_all() && clearance_.empty()) return;
    fit_.set_visible(visible);
    correlation_.set_visible(visible);
    clearance_ = visible.are_all() ? Image() : squared_distance_transform(visible.mask());
    if (!coarse_) return;
    const VisiblePixels blocks = visible.blocks(factor_);
    coarse_fit_->set_visible(blocks);
    coarse_->set_visible(blocks);
    approach_->set_visible(blocks.every_row(kApproachSpacing));
}

Image Locator::residual() {
    fit_.draw_undrawn();
    Image residual = fit_.darkness().inner();
    for (int y = 0; y < residual.height(); ++y) {
        const float* transmission = fit_.transmission().row(y);
        float* row = residual.row(y);
        for (int x = 0; x < residual.width(); ++x) row[x] -= 1.0F - transmission[x];
    }
    return residual;
}

/// Distance to the nearest pixel that is not visible, less the pixel of its own [px].
double Locator::clearance(Vec2 p) const {
    if (clearance_.empty()) return std::numeric_limits<double>::infinity();
    const auto at = [](double v, int n) {
        return std::clamp(static_cast<int>(std::lround(v)), 0, n - 1);
    };
    const float squared = clearance_(at(p.x, clearance_.width()), at(p.y, clearance_.height()));
    return std::sqrt(static_cast<double>(squared)) - 1;
}

/// Most of the search on an image of blocks: its pixels are fewer by the square of the factor.
void Locator::search_coarsely(const DetectionOptions& detection,
                              const RefinementOptions& refinement, Located& found) {
    reduce(fit_.darkness(), factor_, 1, threads_, coarse_image_);
    coarse_fit_->restart(coarse_image_);
    SphereSearch search(*coarse_fit_, *coarse_, detection);
    search.seed();
    RefinementOptions rough = rough_version(refinement, model_.disc);
    rough.tolerance /= factor_;
    search.run(rough);
    std::vector<Vec2> places;
    places.reserve(search.fit().positions().size());
    for (const Vec2 p : search.fit().positions()) places.push_back(correlation_.in_frame(p));
    std::vector<double> explained = search.fit().explained();
    for (double& e : explained) e *= factor_ * factor_;
    place_all({places, explained}, kSwept * model_.disc.edge_width);
    const SphereSearch::Summary& summary = search.summary();
    found.passes += summary.passes;
    found.added += summary.added;
    found.removed += summary.removed;
    found.maps_skipped += summary.maps_skipped;
    found.maps_in_part += summary.maps_in_part;
    found.coarse_steps += summary.steps;
    found.detect_seconds += summary.detect_seconds;
    found.refine_seconds += summary.refine_seconds;
}

/// Spheres that have moved, refined on an image of blocks: to a few hundredths of a pixel. Nothing
/// is added or removed, and who went far is left where it was: the fine search judges by its own
/// pixels. Empty if the misfit of half a sphere or more is left in so many places that a cold
/// search is the shorter way.
Locator::Scene Locator::approached(const RefinementOptions& refinement,
                                   const std::vector<Vec2>& start, Located& found) {
    const auto begin = Clock::now();
    reduce(fit_.darkness(), factor_, kApproachSpacing, threads_, coarse_image_);
    approach_->restart(coarse_image_);
    std::vector<Vec2> places;
    places.reserve(start.size());
    for (const Vec2 p : start) places.push_back(correlation_.in_map(p));
    approach_->add_all(places);
    RefinementOptions rough = rough_version(refinement, model_.disc);
    rough.tolerance /= factor_;
    found.coarse_steps += approach_->refine(rough, Drawing::roughly).steps;
    const ResidualBlocks residual(approach_->darkness(), approach_->transmission(),
                                  static_cast<int>(std::ceil(approach_->disc().reach())), threads_);
    double wrong = 0;
    for (const PixelBlock& b : residual.holding(0.5 * coarse_->full_gain() / kApproachSpacing)) {
        wrong += static_cast<double>(b.x1 - b.x0) * (b.y1 - b.y0);
    }
    found.approached =
        wrong <= kMostWrong * approach_->darkness().width() * approach_->darkness().height();
    Scene scene;
    if (found.approached) {
        scene.explained = approach_->explained();
        for (double& e : scene.explained) e *= factor_ * factor_ * kApproachSpacing;
        const double farthest = kFarthest * model_.disc.diameter;
        for (std::size_t j = 0; j < places.size(); ++j) {
            const Vec2 p = correlation_.in_frame(approach_->positions()[j]);
            const bool is_near = squared_norm(p - start[j]) < farthest * farthest;
            scene.position.push_back(is_near ? p : start[j]);
        }
    }
    found.refine_seconds += seconds_since(begin);
    return scene;
}

/// Discs on an empty fit, with the information about all of them.
void Locator::place_all(const Scene& scene, std::optional<double> left) {
    early_ = add_all(fit_, scene.position, scene.explained, left);
    early_revision_ = fit_.revision();
}

/// Joint steps d beyond this are made again [px]: what one neglects, of the order d²/w, stays below
/// the standard error of an isolated sphere.
double Locator::far(double noise) const {
    const double error = std::max(kLeastError, noise / std::sqrt(model_.disc.information()));
    return std::min({kNewton * model_.disc.edge_width, JointFit::kLongestStep,
                     std::sqrt(model_.disc.edge_width * error)});
}

/// Up to here a step need not be drawn [px].
double Locator::least_drawn(double noise, const RefinementOptions& refinement) const {
    const double error = noise / std::sqrt(model_.disc.information());
    return std::max(refinement.tolerance, std::min(kUndrawn * error, far(noise)));
}

/// Rounds of sweeps and a joint Newton step until nobody goes far; small steps are not drawn, or
/// `exactly`. Who goes very far, or far more than once, is swept in between, where each step is
/// checked: discs hardly wider than a pixel may step to and fro. From the second round on, that is
/// known anew of the neighbours of discs that went elsewhere only. Whether all are settled.
bool Locator::settle(SphereSearch& search, const RefinementOptions& refinement, bool exactly,
                     JointInformation& information, Located& found) {
    std::int64_t went_far = 0;
    for (int round = 0; round < kMostSettling; ++round) {
        search.finish(swept(refinement, model_.disc), Drawing::roughly);
        const double noise = search.summary().noise;
        const double lag = exactly ? refinement.tolerance : least_drawn(noise, refinement);
        const auto begin = Clock::now();
        const std::vector<char> disturbed = fit_.take_disturbed();
        const auto discs = static_cast<std::int64_t>(disturbed.size());
        const bool is_update =
            round > 0 && static_cast<std::int64_t>(information.own.size()) == discs &&
            static_cast<double>(went_far) <= kMostFar * static_cast<double>(discs);
        if (is_update) {
            update_information(fit_, disturbed, information);
            found.steps += std::count(disturbed.begin(), disturbed.end(), 1);
        } else {
            const bool is_known = early_ && early_revision_ == fit_.revision();
            information = is_known ? *std::exchange(early_, {}) : joint_information(fit_);
            found.steps += discs;
        }
        const auto joint = joint_step(information, 0.1 * refinement.tolerance);
        went_far = fit_.displace(joint, lag, far(noise), round > 0);
        found.refine_seconds += seconds_since(begin);
        if (went_far == 0) return true;
    }
    return false;
}

/// The few that no joint step settles are swept to the end.
void Locator::settle_rest(SphereSearch& search, const RefinementOptions& refinement,
                          JointInformation& information) {
    fit_.draw_undrawn();
    search.finish(refinement, Drawing::exactly);
    if (information.own.size() != fit_.positions().size()) information = joint_information(fit_);
}

Located Locator::locate(const Image& darkness, const DetectionOptions& detection,
                        const RefinementOptions& refinement, const std::vector<Vec2>& start,
                        double step) {
    return locate([&](int y, float* row) { std::copy_n(darkness.row(y), darkness.width(), row); },
                  detection, refinement, start, step);
}

/// Spheres are added and removed until nothing changes, and all of them settled.
void Locator::find_all(SphereSearch& search, const DetectionOptions& detection,
                       const RefinementOptions& refinement, bool exactly, Settled& settled,
                       Located& found) {
    bool is_settled = true;
    const auto settle_all = [&] {
        is_settled = settle(search, refinement, exactly, settled.information, found);
        if (!is_settled) {
            fit_.draw_undrawn();
            search.finish(swept(refinement, model_.disc), Drawing::exactly);
        }
        settled.gain = undrawn_gain(fit_, settled.information);
        settled.residual.emplace(residual_of(fit_, settled.gain));
        settled.revision = fit_.revision();
    };
    // A warm frame has all its spheres, as a rule: these are settled before anybody asks.
    if (found.warm) settle_all();
    if (!found.warm || search.misses_any(*settled.residual)) {
        search.run(rough_version(refinement, model_.disc));
        settle_all();
    }
    if (detection.goal == SearchGoal::every_sphere &&
        search.look_again(swept(refinement, model_.disc), *settled.residual)) {
        settle_all();
    }
    if (!is_settled) settle_rest(search, refinement, settled.information);
}

Located Locator::locate(const JointFit::WriteRow& darkness, const DetectionOptions& detection,
                        const RefinementOptions& refinement, const std::vector<Vec2>& start,
                        double step) {
    Located found;
    fit_.restart(darkness);
    SphereSearch search(fit_, correlation_, detection);
    JointFit& fit = fit_;
    const bool moved = coarse_ && step > kNear * model_.disc.edge_width;
    const Scene scene =
        moved && !start.empty() ? approached(refinement, start, found) : Scene{start, {}};
    if (!scene.position.empty()) {
        found.warm = true;
        std::optional<double> left;
        if (moved) left = kSwept * model_.disc.edge_width;
        if (!moved && step > 0) left = 2 * step;
        place_all(scene, left);
    } else if (coarse_) {
        search_coarsely(detection, refinement, found);
    } else {
        search.seed();
    }
    // What is made of the image of all discs next is no better than where they are drawn.
    const bool is_corrected = !model_.is_product();
    Settled settled;
    find_all(search, detection, refinement, is_corrected, settled, found);
    const Image original = is_corrected ? fit.darkness().inner() : Image();
    for (int round = 1; is_corrected && round <= kCorrections; ++round) {
        const auto begin = Clock::now();
        const std::vector<Vec2> met = fit.positions();
        const Image product = product_image(original, fit.transmission(), met, model_, threads_);
        fit.restart(product);
        place_all({met, {}}, kSwept * model_.disc.edge_width);
        found.refine_seconds += seconds_since(begin);
        search.forget_judgement();
        if (!settle(search, refinement, round < kCorrections, settled.information, found)) {
            settle_rest(search, refinement, settled.information);
        }
    }

    const SphereSearch::Summary& summary = search.summary();
    found.passes += summary.passes;
    found.added += summary.added;
    found.removed += summary.removed;
    found.maps_skipped += summary.maps_skipped;
    found.maps_in_part += summary.maps_in_part;
    found.settled_detection = summary.settled_detection;
    found.trials = summary.trials;
    found.evidence = summary.evidence;
    found.noise = summary.noise;
    found.steps += summary.steps;
    found.detect_seconds += summary.detect_seconds;
    found.refine_seconds += summary.refine_seconds;
    const auto begin = Clock::now();
    if (fit.revision() == settled.revision) {
        found.residual_rms = settled.residual->rms(fit.pixels());
    } else {
        settled.gain = undrawn_gain(fit, settled.information);
        found.residual_rms = fit.residual_rms(settled.gain);
    }
    // Discs at the border have explained what is dark there; half unseen, they are not to be
    // trusted.
    const double border = detection.border * model_.disc.diameter;
    const std::vector<double> residuals = fit.residuals(settled.gain);
    const std::vector<double>& explained = fit.explained();
    const std::vector<PositionCovariance> covariances =
        joint_covariance(settled.information, threads_);
    for (std::size_t j = 0; j < residuals.size(); ++j) {
        const Vec2 p = fit.positions()[j];
        found.unsettled += fit.is_restless(j, swept(refinement, model_.disc).tolerance) ? 1 : 0;
        if (std::min({p.x, p.y, fit.darkness().width() - 1 - p.x, fit.darkness().height() - 1 - p.y,
                      clearance(p)}) < border) {
            continue;
        }
        const Vec2 error{std::sqrt(covariances[j].xx), std::sqrt(covariances[j].yy)};
        // Where the last step is less than the uncertainty, the position is as good as any.
        const double noise = std::max(found.noise, residuals[j]);
        if (!std::isfinite(p.x + p.y) ||
            fit.step_left(j) > std::max(refinement.tolerance, noise * norm(error))) {
            ++found.rejected;
            continue;
        }
        found.position.push_back(p);
        found.error.push_back(error);
        found.residual.push_back(residuals[j]);
        found.explained.push_back(explained[j]);
    }
    found.fitted = fit.positions();
    found.refine_seconds += seconds_since(begin);
    return found;
}

}  // namespace grainfield::tracking
