#include "tracking/locate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "tracking/detect/distance_transform.h"
#include "tracking/model/product_image.h"
#include "tracking/refine/edge_residuals.h"
#include "tracking/refine/misfit_correlation.h"

namespace grainfield::tracking {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Up to this length one joint step is as good as any number of single ones: for an isolated disc
// the error is of third order, for overlapping ones of second order in the step.
constexpr double kNewton = 0.08;          // [w]
constexpr double kLeastError = 1e-4;      // [px]
constexpr double kSweepTolerance = 0.03;  // [w] where sweeps end: a joint step does the rest
constexpr int kRoughSweeps = 4;
constexpr int kMostSettling = 4;  // rounds
constexpr int kJudgedRounds = 2;  // of them, in which spheres are judged and the noise is measured
// A step of less than this many standard errors of an isolated sphere stays pending.
constexpr double kPendingErrors = 8;
// The product image is made for the positions of the fit before; in crystals the first one moves
// some spheres far. From frame to frame one is enough: on films of two cameras a second one changes
// neither what is found nor the error.
constexpr int kProductImages = 2;
constexpr int kProductImagesWarm = 1;
// The core of a mirror-like sphere is dark wherever no other lies above it. It is a disc of
// diameter a/√2: rays that meet the sphere within go up again. D is 0.85 to 0.9 a, and the blur
// takes from the core. Edges are taken sharper than they are, so that cores that touch stay apart.
// On five cameras drawn at random 0.75 to 0.78 D with 0.2 to 0.35 w find alike.
constexpr double kCoreDiameter = 0.75;  // [D]
constexpr double kCoreEdge = 0.3;       // [w]
/// Where every sphere need only explain this share the model describes the frame, and what the
/// search ends with is right.
constexpr double kWellDescribed = 0.05;
constexpr double kMostUnlike = 0.1;  // of all discs: neither search knows what the frame shows

}  // namespace

Located in_frame(Located found, Binning blocks) {
    const double factor = blocks.factor;
    for (std::vector<Vec2>* places : {&found.position, &found.fitted}) {
        for (Vec2& p : *places) p = blocks.in_frame(p);
    }
    for (Vec2& error : found.error) error *= factor;
    for (double& misfit : found.explained) misfit *= factor * factor;
    return found;
}

/// A frame on its way through the stages.
struct Locator::Frame {
    const DetectionOptions& detection;
    const RefinementOptions& refinement;
    SphereSearch search;
    Located found = {};
    /// When all discs had settled last: what is left of the image, less the gain of pending steps,
    /// and the revision of the fit.
    std::vector<double> gain = {};
    std::optional<ResidualBlocks> residual = {};
    std::uint64_t revision = 0;
    bool is_settled = true;
    bool follows = false;        ///< warm, and the spheres have moved since
    bool knew_doubtful = false;  ///< the frame before showed that doubtful spheres are false
    bool is_unsure = false;      ///< two searches found different spheres in many places

    void count(const SphereSearch::Summary& summary) {
        found.passes += summary.passes;
        found.added += summary.added;
        found.removed += summary.removed;
        found.maps_skipped += summary.maps_skipped;
        found.maps_in_part += summary.maps_in_part;
        found.detect_seconds += summary.detect_seconds;
        found.refine_seconds += summary.refine_seconds;
    }
};

Locator::Locator(int width, int height, DiscModel model, int threads)
    : model_(std::move(model)),
      threads_(threads),
      correlation_(width, height, model_.disc, DiscCorrelation::suitable_factor(model_.disc)),
      fit_(Image(width, height), model_.disc, threads) {
    const int factor = correlation_.factor();
    if (CoarseSearch::suits(width, height, factor)) {
        coarse_.emplace(width, height, model_.disc, factor, threads);
    }
}

void Locator::set_threads(int threads) {
    threads_ = threads;
    fit_.set_threads(threads);
    if (coarse_) coarse_->set_threads(threads);
    if (cores_) cores_->set_threads(threads);
}

void Locator::set_visible(const VisiblePixels& visible) {
    if (visible.are_all() && clearance_.empty()) return;
    fit_.set_visible(visible);
    correlation_.set_visible(visible);
    clearance_ = visible.are_all() ? Image() : squared_distance_transform(visible.mask());
    if (coarse_) coarse_->set_visible(visible);
    visible_ = visible;
    cores_.reset();
}

Image Locator::residual() {
    Image residual(fit_.darkness().width(), fit_.darkness().height());
    write_residual(residual);
    return residual;
}

void Locator::write_residual(Image& residual) {
    fit_.draw_pending();
    for (int y = 0; y < residual.height(); ++y) {
        const float* darkness = fit_.darkness().row(y);
        const float* transmission = fit_.transmission().row(y);
        float* row = residual.row(y);
        for (int x = 0; x < residual.width(); ++x) row[x] = darkness[x] - (1.0F - transmission[x]);
    }
}

/// Sweeps end where one joint step does the rest.
RefinementOptions Locator::sweeps_of(const RefinementOptions& refinement) const {
    RefinementOptions sweeps = refinement;
    sweeps.tolerance = std::max(refinement.tolerance, kSweepTolerance * model_.disc.edge_width);
    return sweeps;
}

/// Rough rounds stop early: positions only need to be good enough to judge the residual.
RefinementOptions Locator::rough_sweeps_of(const RefinementOptions& refinement) const {
    RefinementOptions rough = sweeps_of(refinement);
    rough.max_sweeps = std::min(refinement.max_sweeps, kRoughSweeps);
    return rough;
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

/// Joint steps d beyond this are made again [px]: what one neglects, of the order d²/w, stays below
/// the standard error of an isolated sphere.
double Locator::far(double noise) const {
    const double error = std::max(kLeastError, noise / std::sqrt(model_.disc.information()));
    return std::min({kNewton * model_.disc.edge_width, JointFit::kLongestStep,
                     std::sqrt(model_.disc.edge_width * error)});
}

/// Shorter steps stay pending [px].
double Locator::least_drawn(double noise, const RefinementOptions& refinement) const {
    const double error = noise / std::sqrt(model_.disc.information());
    return std::max(refinement.tolerance, std::min(kPendingErrors * error, far(noise)));
}

void Locator::place_all(const StartingDiscs& discs, std::optional<double> left) {
    solver_.place_all(fit_, discs.position, discs.explained, left);
}

/// The start refined on blocks; empty if a cold search is the shorter way.
StartingDiscs Locator::approached(Frame& frame, const std::vector<Vec2>& start) {
    const auto begin = Clock::now();
    CoarseSearch::Approach approach =
        coarse_->approach(fit_.darkness(), start, rough_sweeps_of(frame.refinement));
    frame.found.coarse_steps += approach.steps;
    frame.found.approached = approach.is_near;
    frame.found.refine_seconds += seconds_since(begin);
    return std::move(approach.discs);
}

/// Stage 1: discs on an empty fit.
void Locator::start_discs(Frame& frame, const std::vector<Vec2>& start, double step) {
    const double swept = kSweepTolerance * model_.disc.edge_width;
    const bool moved = coarse_ && step > kNear * model_.disc.edge_width;
    const StartingDiscs warm =
        moved && !start.empty() ? approached(frame, start) : StartingDiscs{start, {}};
    if (!warm.position.empty()) {
        frame.found.warm = true;
        std::optional<double> left;
        if (moved) left = swept;
        if (!moved && step > 0) {
            // They are swept first, and no joint step follows before that.
            fit_.add_all(warm.position, warm.explained, 2 * step);
        } else {
            place_all(warm, left);
        }
        return;
    }
    DetectionOptions detection = frame.detection;
    detection.doubtful_are_false = false;
    frame.search.begin_cold();
    if (coarse_) {
        const StartingDiscs cold =
            coarse_->search(fit_.darkness(), detection, rough_sweeps_of(frame.refinement));
        place_all(cold, swept);
        frame.count(coarse_->summary());
        frame.found.coarse_steps += coarse_->summary().steps;
    } else {
        frame.search.seed();
    }
}

/// What limits positions: the camera's noise, or what the model of the film leaves over, if a frame
/// has as much of it [contrast].
double Locator::unexplained_by_model(const Frame& frame) const {
    const SphereSearch::Summary& now = frame.search.summary();
    return std::max(now.noise, std::min(now.misfit, expected_misfit_));
}

/// Rounds of sweeps and a joint Newton step until no disc goes far. Small steps stay pending. Discs
/// that go very far, or far more than once, are swept in between, where each step is checked: discs
/// hardly wider than a pixel may step to and fro. Before the last fit of a frame a disc has gone
/// far only if its step was cut short: the error of a step that was not is at most 0.04 px where
/// w = 1.6 px, less than the positions go in the next fit. A warm frame takes no joint step there
/// at all. Whether all discs have settled.
bool Locator::settle(Frame& frame, bool is_last) {
    const double tolerance = frame.refinement.tolerance;
    const RefinementOptions sweeps = sweeps_of(frame.refinement);
    for (int round = 0; round < kMostSettling; ++round) {
        // After the first joint step noise and misfit are those of settled discs, or nearly so.
        if (round < kJudgedRounds) {
            frame.search.finish(sweeps, Drawing::roughly);
        } else {
            frame.search.sweep(sweeps, Drawing::roughly);
        }
        // What moves spheres most is fitted next, and a step before it brings nothing.
        if (frame.follows && !is_last) return true;
        const double unexplained = unexplained_by_model(frame);
        const double lag = least_drawn(unexplained, frame.refinement);
        const auto begin = Clock::now();
        const JointSolver::StepCount step =
            solver_.step(fit_,
                         {.accuracy = 0.1 * tolerance,
                          .least_drawn = lag,
                          .far = is_last ? far(unexplained) : JointFit::kLongestStep},
                         round == 0);
        frame.found.steps += step.discs;
        ++frame.found.joint_steps;
        frame.found.refine_seconds += seconds_since(begin);
        if (step.went_far == 0) return true;
    }
    return false;
}

/// The few discs that no joint step settles are swept to the end.
void Locator::sweep_to_rest(Frame& frame) {
    frame.search.finish(frame.refinement, Drawing::exactly);
    solver_.complete(fit_);
}

void Locator::settle_and_judge(Frame& frame) {
    frame.is_settled = settle(frame, model_.is_product());
    if (!frame.is_settled) frame.search.finish(sweeps_of(frame.refinement), Drawing::exactly);
    if (frame.follows && !model_.is_product()) {
        // Sweeps leave less than their tolerance pending.
        frame.gain.assign(fit_.positions().size(), 0);
    } else {
        frame.gain = solver_.gain(fit_);
    }
    frame.residual.emplace(residual_of(fit_, frame.gain));
    frame.revision = fit_.revision();
}

/// Stages 2 to 4: spheres are added and removed until nothing changes, and all of them settled.
void Locator::search(Frame& frame) {
    // A warm frame has all its spheres, as a rule: they settle before any is looked for.
    if (frame.found.warm) settle_and_judge(frame);
    // Where edges meet by another rule the product leaves much everywhere. What is missing beside
    // others is looked for below.
    const auto misses = [&] {
        return frame.follows && !model_.is_product()
                   ? frame.search.misses_whole_ones(*frame.residual)
                   : frame.search.misses_any(*frame.residual);
    };
    if (!frame.found.warm || misses()) {
        frame.search.run(rough_sweeps_of(frame.refinement));
        settle_and_judge(frame);
    }
    // While the model is still wrong, most spheres are enough.
    if (frame.detection.goal == SearchGoal::every_sphere &&
        frame.search.look_again(sweeps_of(frame.refinement), *frame.residual)) {
        // Meeting edges are fitted next, and settle all again.
        if (model_.is_product() || is_searched_for_cores(frame)) settle_and_judge(frame);
    }
    if (!frame.is_settled) sweep_to_rest(frame);
}

/// Where a search for cores finds other places, the better arrangement stays. Whether any was
/// tried.
bool Locator::take_better(Frame& frame) {
    const Image darkness = fit_.darkness().inner();
    DetectionOptions detection = frame.detection;
    detection.separation *= model_.disc.diameter / cores_->model_.disc.diameter;
    detection.cores = CoreSearch::never;
    const RefinementOptions sweeps = sweeps_of(frame.refinement);
    const Located found =
        cores_->locate(darkness, detection, cores_->rough_sweeps_of(frame.refinement));
    OtherArrangement other = compare_arrangements(
        fit_.positions(), found.fitted, model_.disc.diameter, darkness.width(), darkness.height());
    std::vector<ArrangementDifference>& differences = other.differences;
    frame.found.arrangements += static_cast<int>(differences.size());
    const double most = kMostUnlike * static_cast<double>(fit_.positions().size());
    frame.is_unsure = static_cast<double>(other.unlike) > most;
    if (differences.empty() || static_cast<double>(other.unlike_in_large) > most) return false;
    // Either disc is wrong in its own way: each arrangement is judged with both.
    std::vector<ArrangementDifference> as_other = differences;
    frame.found.steps += try_differences(cores_->fit_, as_other, true, sweeps);
    frame.found.steps += try_differences(fit_, differences, false, sweeps);
    std::vector<ArrangementDifference> better;
    for (std::size_t k = 0; k < differences.size(); ++k) {
        if (differences[k].change < as_other[k].change) better.push_back(differences[k]);
    }
    frame.found.arrangements_taken += static_cast<int>(better.size());
    if (!better.empty()) frame.found.steps += take_differences(fit_, better, sweeps);
    return true;
}

bool Locator::is_searched_for_cores(const Frame& frame) const {
    const CoreSearch wanted = frame.detection.cores;
    return wanted != CoreSearch::never &&
           (wanted != CoreSearch::cold_frames || !frame.found.warm) &&
           frame.detection.goal == SearchGoal::every_sphere &&
           frame.search.summary().evidence > kWellDescribed;
}

/// Stage 5: where a search for cores finds other discs, the better arrangement stays.
void Locator::compare_with_cores(Frame& frame) {
    if (!is_searched_for_cores(frame)) return;
    const auto begin = Clock::now();
    if (!cores_) {
        const DiscProfile core{kCoreDiameter * model_.disc.diameter,
                               kCoreEdge * model_.disc.edge_width, model_.disc.shape};
        cores_ = std::make_unique<Locator>(fit_.darkness().width(), fit_.darkness().height(),
                                           DiscModel(core), threads_);
        cores_->set_visible(visible_);
    }
    cores_->expect_misfit(expected_misfit_);
    const bool any = take_better(frame);
    frame.found.detect_seconds += seconds_since(begin);
    if (!any) return;
    frame.search.forget_judgement();
    settle_and_judge(frame);
    if (frame.search.look_again(sweeps_of(frame.refinement), *frame.residual)) {
        settle_and_judge(frame);
    }
    if (!frame.is_settled) sweep_to_rest(frame);
}

/// Stage 6: where spheres have no room one disc takes the place of two. Warm frames, and those that
/// are fitted again for their light, start from what stayed.
void Locator::put_one_for_two(Frame& frame) {
    if (frame.follows || frame.detection.cores == CoreSearch::never ||
        frame.detection.goal != SearchGoal::every_sphere ||
        !frame.search.put_one_for_two(sweeps_of(frame.refinement))) {
        return;
    }
    settle_and_judge(frame);
    if (!frame.is_settled) sweep_to_rest(frame);
}

/// Stage 7: the fit again on the image that the product of transmissions should see.
void Locator::fit_overlaps(Frame& frame) {
    fit_.darkness().copy_to(original_);
    const int rounds = frame.follows ? kProductImagesWarm : kProductImages;
    for (int round = 1; round <= rounds; ++round) {
        const auto begin = Clock::now();
        product_image(original_, fit_.positions(), model_, threads_, seen_);
        // All discs are restless: a third of them go far, and a joint step that is made before they
        // are swept is made twice.
        fit_.look_at(seen_, 2 * kSweepTolerance * model_.disc.edge_width);
        frame.found.refine_seconds += seconds_since(begin);
        frame.search.forget_judgement();
        if (!settle(frame, round == rounds)) sweep_to_rest(frame);
    }
}

/// Stage 8. Where it was seen now that doubtful spheres are false, all is searched again.
void Locator::search_without_doubtful(Frame& frame) {
    if (frame.knew_doubtful || !frame.search.summary().doubtful_are_false) return;
    if (!model_.is_product()) {
        const std::vector<Vec2> positions = fit_.positions();
        fit_.restart(original_);
        place_all({positions, {}}, kSweepTolerance * model_.disc.edge_width);
    }
    frame.search.start_over();
    frame.search.run(rough_sweeps_of(frame.refinement));
    settle_and_judge(frame);
    if (frame.search.look_again(sweeps_of(frame.refinement), *frame.residual)) {
        settle_and_judge(frame);
    }
    if (!frame.is_settled) sweep_to_rest(frame);
    // What was put right may have been put back.
    put_one_for_two(frame);
    if (!model_.is_product()) fit_overlaps(frame);
}

/// Stage 9. Discs at the border have explained what is dark there; half unseen, they are not
/// reported.
Located Locator::report(Frame& frame) {
    Located& found = frame.found;
    const SphereSearch::Summary& summary = frame.search.summary();
    frame.count(summary);
    found.settled_detection = summary.settled_detection && !frame.is_unsure;
    found.trials = summary.trials;
    found.trials_kept = summary.trials_kept;
    found.mended = summary.mended;
    found.evidence = summary.evidence;
    found.doubtful_are_false = summary.doubtful_are_false;
    found.noise = summary.noise;
    found.steps += summary.steps;
    const auto begin = Clock::now();
    if (fit_.revision() == frame.revision) {
        found.residual_rms = frame.residual->rms(fit_.scene().pixels());
    } else {
        frame.gain = solver_.gain(fit_);
        found.residual_rms = fit_.residual_rms(frame.gain);
    }
    const double border = frame.detection.border * model_.disc.diameter - frame.detection.beyond;
    const double tolerance = frame.refinement.tolerance;
    const JointFit::Residuals left = fit_.residuals(frame.gain);
    const std::vector<double>& residuals = left.within_reach;
    const std::vector<EdgeKind> kinds = edge_kinds(
        fit_.positions(), model_.disc, fit_.darkness().width(), fit_.darkness().height());
    const std::vector<double> at_edge = edge_residuals(left, kinds, found.noise);
    found.correlation = misfit_correlation(fit_, found.noise, left);
    const std::vector<double>& explained = fit_.explained();
    const std::vector<PositionCovariance> covariances = solver_.covariance(threads_);
    for (std::size_t j = 0; j < residuals.size(); ++j) {
        const Vec2 p = fit_.positions()[j];
        found.unsettled += fit_.is_restless(j, sweeps_of(frame.refinement).tolerance) ? 1 : 0;
        if (std::min({p.x, p.y, fit_.darkness().width() - 1 - p.x,
                      fit_.darkness().height() - 1 - p.y, clearance(p)}) < border) {
            continue;
        }
        const Vec2 error{std::sqrt(covariances[j].xx), std::sqrt(covariances[j].yy)};
        // Where the last step is less than the uncertainty, the position is as good as any.
        const double noise = effective_noise(found.noise, found.correlation, at_edge[j]);
        if (!std::isfinite(p.x + p.y) ||
            fit_.step_left(j) > std::max(tolerance, noise * norm(error))) {
            ++found.rejected;
            continue;
        }
        found.position.push_back(p);
        found.error.push_back(error);
        found.residual.push_back(residuals[j]);
        found.edge_residual.push_back(at_edge[j]);
        found.explained.push_back(explained[j]);
    }
    found.fitted = fit_.positions();
    found.refine_seconds += seconds_since(begin);
    return std::move(found);
}

Located Locator::locate(const Image& darkness, const DetectionOptions& detection,
                        const RefinementOptions& refinement, const std::vector<Vec2>& start,
                        double step) {
    return locate([&](int y, float* row) { std::copy_n(darkness.row(y), darkness.width(), row); },
                  detection, refinement, start, step);
}

Located Locator::locate(const JointFit::WriteRow& darkness, const DetectionOptions& detection,
                        const RefinementOptions& refinement, const std::vector<Vec2>& start,
                        double step) {
    fit_.restart(darkness);
    Frame frame{detection, refinement,
                SphereSearch(fit_, correlation_, detection, correction_ ? &*correction_ : nullptr)};
    start_discs(frame, start, step);
    frame.knew_doubtful = frame.search.summary().doubtful_are_false;
    // A fit of the same frame, as that of the calibration, is made again as a cold one is.
    frame.follows = frame.found.warm && step > 0;
    search(frame);
    compare_with_cores(frame);
    put_one_for_two(frame);
    if (!model_.is_product()) fit_overlaps(frame);
    search_without_doubtful(frame);
    return report(frame);
}

}  // namespace grainfield::tracking
