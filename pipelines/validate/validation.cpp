#include "pipelines/validate/validation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "analysis/analysis.h"
#include "analysis/order/bond_order.h"
#include "core/errors.h"
#include "core/stored_trajectory.h"
#include "core/support/interrupt.h"
#include "pipelines/film/watched_frames.h"
#include "pipelines/size_check.h"
#include "tracking/score/edge_noise.h"

namespace grainfield::pipelines {

namespace {

using tracking::Tracker;

/// Tracks are scored against particles that one can tell apart.
void require_identities(const Snapshot& truth) {
    if (truth.id.size() == truth.size()) return;
    throw InputError(
        {.problem = fmt::format("the truth of frame {} has no identities", truth.frame),
         .actual = {},
         .expected = "a particle number that stays the same from frame to frame",
         .suggestion = "write it with ids, as 'grainfield simulate md' does"});
}

/// The part of the truth that the tracker could report, in the box of the frame.
Snapshot visible(const Snapshot& truth, const ScoredView& view) {
    Snapshot out;
    out.frame = truth.frame;
    out.time = truth.time;
    out.box.origin = {-0.5, -0.5};
    out.box.length = {static_cast<double>(view.width), static_cast<double>(view.height)};
    const double margin = view.disc.diameter / 4;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Vec2 p = truth.position[i];
        if (p.x < margin || p.y < margin || p.x > view.width - 1 - margin ||
            p.y > view.height - 1 - margin) {
            continue;
        }
        out.position.push_back(p);
        out.id.push_back(truth.id[i]);
        if (!truth.layer.empty()) out.layer.push_back(truth.layer[i]);
    }
    return out;
}

/// The noise on edges in the first good frame [contrast]; where it cannot be measured, that of the
/// tracker's residual.
double noise_of(const ValidationCase& scene, const Tracker& tracker) {
    for (std::int64_t i = 0; i < scene.frames.count(); ++i) {
        const Frame frame = scene.frames.read(i);
        if (frame.status != FrameStatus::ok) continue;
        const double noise =
            tracking::edge_noise(frame.image, tracker.model(), scene.truth.read(i).position);
        if (noise > 0) return noise;
    }
    return tracker.model().noise;
}

ScoredView view_of(const ValidationCase& scene, const ValidationSettings& settings,
                   const Tracker& tracker, double sphere_diameter) {
    ScoredView view;
    view.width = scene.frames.width();
    view.height = scene.frames.height();
    view.sphere_diameter = sphere_diameter;
    view.disc = tracker.model().disc;
    view.noise = noise_of(scene, tracker);
    view.threads = settings.threads;
    view.span = {view.width + 0.0, view.height + 0.0};
    if (scene.truth.count() > 0) {
        // A table of positions may say that its box is periodic; the truth of a renderer never is.
        const Box box = scene.truth.read(0).box;
        if (box.boundary[0] == Boundary::periodic)
            view.span.x = std::min(view.span.x, box.length.x);
        if (box.boundary[1] == Boundary::periodic)
            view.span.y = std::min(view.span.y, box.length.y);
    }
    return view;
}

/// Takes what the tracker writes, scores it, and keeps it beside its truth.
class ScoringSink : public SnapshotSink {
 public:
    ScoringSink(SnapshotSource& truth, ValidationScores& scores, StoredTrajectory& found,
                StoredTrajectory& seen)
        : truth_(truth), scores_(scores), found_(found), seen_(seen) {}

    void write(const Snapshot& snapshot) override {
        skip_to(snapshot.frame);
        add(snapshot);
        found_.write(snapshot);
    }
    /// Frames that the tracker left out have missed all their particles.
    void skip_to(std::int64_t frame) {
        while (next_ < frame) {
            Snapshot nothing;
            nothing.frame = next_;
            add(nothing);
        }
    }
    /// Whether all true positions are whole pixels, more than chance or a lattice would make.
    bool is_whole() const { return positions_ >= least_told && whole_ == positions_; }

 private:
    void add(const Snapshot& found) {
        Snapshot truth = truth_.read(next_);
        truth.frame = next_;
        require_identities(truth);
        scores_.add(truth, found);
        for (const Vec2 p : truth.position) {
            ++positions_;
            if (p.x == std::floor(p.x) && p.y == std::floor(p.y)) ++whole_;
        }
        if (found.size() > 0) {
            Snapshot seen = visible(truth, scores_.view());
            seen.time = found.time;
            seen_.write(seen);
        }
        ++next_;
    }

    SnapshotSource& truth_;
    ValidationScores& scores_;
    StoredTrajectory& found_;
    StoredTrajectory& seen_;
    static constexpr std::int64_t least_told = 20;
    std::int64_t next_ = 0;
    std::int64_t positions_ = 0;
    std::int64_t whole_ = 0;  ///< of them, with whole coordinates
};

Results run_of(const std::string& label, const StoredTrajectory& snapshots) {
    Results run;
    run.label = label;
    run.source = snapshots.info();
    run.identity = identity_of(run.source);
    run.frames = snapshots.count();
    double particles = 0;
    for (const Snapshot& s : snapshots.trajectory().snapshots) {
        particles += static_cast<double>(s.size());
    }
    run.particles_mean = particles / static_cast<double>(std::max<std::int64_t>(1, run.frames));
    if (run.frames > 0) run.box = snapshots.at(0).box;
    return run;
}

void analyse(Results& run, StoredTrajectory& snapshots, const ValidationSettings& settings,
             ValidationOutcome& outcome, RunPlan& plan) {
    Progress progress("analysing " + run.label + " positions", snapshots.count(), "frames",
                      settings.verbosity);
    analysis::AnalysisOptions usual;
    usual.of<analysis::FitOptions>() = settings.fit;
    run.observables =
        analysis::measure(snapshots, usual,
                          {.threads = settings.threads, .plan = &plan, .progress = &progress})
            .observables;
    analysis::AnalysisOptions free = usual;
    free.observables = {"fit"};
    free.of<analysis::FitOptions>().exponent = analysis::Exponent::free;
    Results fits = analysis::measure(snapshots, free, {.threads = settings.threads});
    for (ObservableResult& result : fits.observables) {
        if (result.name == "fit") outcome.free_fits.push_back(std::move(result));
    }
}

}  // namespace

void require_memory(double particles, double available) {
    constexpr double bytes = 200;  // a particle and frame
    if (particles * bytes <= available) return;
    throw OptionError(
        {.problem = "validation keeps all positions in memory",
         .actual = fmt::format("{:.2g} GB for {:.3g} particles in all frames",
                               1e-9 * particles * bytes, particles),
         .expected = fmt::format("at most {:.2g} GB, which are free", 1e-9 * available),
         .suggestion = "validate fewer frames (run.periods, run.snapshot-every)"});
}

ValidationOutcome validate(const ValidationCase& scene, const ValidationSettings& settings,
                           tracking::TrackSummary& summary, RunPlan& plan) {
    tracking::TrackOptions options = settings.tracking;
    options.threads = settings.threads;
    if (!options.sphere_diameter) options.sphere_diameter = scene.sphere_diameter;
    Progress progress("rendering, tracking and scoring", scene.frames.count(), "frames",
                      settings.verbosity);
    if (settings.slow_frames) progress.announce();
    Tracker tracker(scene.frames, options, plan);
    if (!tracker.is_calibrated()) {
        throw PhysicsError({.problem = "the tracker cannot calibrate on the frames of this scene",
                            .actual = {},
                            .expected = "dark or bright discs of one size",
                            .suggestion = "look at the frames, or give calibrate.disc-diameter"});
    }
    require_memory(
        static_cast<double>(scene.frames.count()) * static_cast<double>(scene.truth.read(0).size()),
        available_memory());
    const double sphere_diameter = tracker.info().diameter;
    ValidationOutcome outcome{
        .scores = ValidationScores(view_of(scene, settings, tracker, sphere_diameter)),
        .tracks = {},
        .runs = {},
        .free_fits = {},
        .effects = {}};
    StoredTrajectory found, seen;
    TrajectoryInfo info = tracker.info();
    info.vibration_frequency = scene.vibration_frequency;
    if (info.time_unit == TimeUnit::frame) info.time_unit = scene.truth.info().time_unit;
    found.set_info(info);
    info.origin = Origin::rendered;
    seen.set_info(info);

    ScoringSink sink(scene.truth, outcome.scores, found, seen);
    PreviewChoice choice(settings.previews, scene.frames.count());
    std::vector<Preview> previews;
    summary = tracker.run(sink, progress,
                          [&](const Frame& frame, const Snapshot& snapshot, std::int64_t) {
                              if (settings.on_frame) settings.on_frame();
                              if (choice.takes(snapshot.frame))
                                  previews.push_back({frame, snapshot, {}});
                          });
    const bool interrupted = caught_signal() != 0;
    if (!interrupted) sink.skip_to(scene.frames.count());
    outcome.tracks = outcome.scores.tracks();
    outcome.truth_is_whole = sink.is_whole();
    if (outcome.truth_is_whole) {
        plan.warn(fmt::format(
            "all true positions are whole pixels: if they were rounded, that alone makes an error "
            "of {} px per axis, and no score can be better",
            kRoundingError));
    }

    warn_of_other_truth(outcome.scores, plan);

    outcome.runs = {run_of("true", seen), run_of("tracked", found)};
    for (Preview& preview : previews) {
        preview.abs_q4 = analysis::abs_q4(preview.snapshot, sphere_diameter, {});
        outcome.runs[1].previews.push_back(preview);
        Snapshot truth = visible(scene.truth.read(preview.snapshot.frame), outcome.scores.view());
        truth.frame = preview.snapshot.frame;
        std::vector<double> order = analysis::abs_q4(truth, sphere_diameter, {});
        outcome.runs[0].previews.push_back({preview.frame, std::move(truth), std::move(order)});
    }
    if (interrupted) {
        plan.warn(WarningCode::interrupted,
                  fmt::format("interrupted after {} of {} frames: scores of those, no analysis",
                              summary.frames, scene.frames.count()));
    } else {
        RunPlan same;  // what is skipped for the one is skipped for the other
        analyse(outcome.runs[0], seen, settings, outcome, same);
        analyse(outcome.runs[1], found, settings, outcome, plan);
    }
    compare_downstream(outcome);
    return outcome;
}

}  // namespace grainfield::pipelines
