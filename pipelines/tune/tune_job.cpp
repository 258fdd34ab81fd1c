#include "pipelines/tune/tune_job.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "analysis/order/bond_order.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/joined_films.h"
#include "pipelines/page/report_page.h"
#include "pipelines/tune/tune_alternatives.h"
#include "pipelines/tune/tune_candidates.h"
#include "pipelines/tune/tune_report.h"
#include "tracking/survey.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;
using tracking::Survey;

Preview preview_of(Frame frame, const Survey& survey, double diameter) {
    Preview preview;
    Snapshot& snapshot = preview.snapshot;
    snapshot.frame = frame.index;
    snapshot.time = frame.time;
    snapshot.box = {.origin = {-0.5, -0.5},
                    .length = {static_cast<double>(frame.image.width()),
                               static_cast<double>(frame.image.height())}};
    snapshot.position = survey.found.position;
    preview.abs_q4 = analysis::abs_q4(snapshot, diameter, {});
    preview.frame = std::move(frame);
    return preview;
}

/// What was found in each frame looked at, and the frame with it.
struct Look {
    std::vector<Survey> surveys;
    std::vector<Preview> previews;
};

Look look_at(const TuneJobOptions& options, const tracking::TrackOptions& tracking,
             WatchedFrames& frames, const tracking::Tracker& tracker, Job& job) {
    tracking::Surveyor surveyor(tracker.model(), tracking, frames.width(), frames.height());
    PreviewChoice choice(options.samples, frames.count());
    Look look;
    Progress progress("looking at", std::min<std::int64_t>(options.samples, frames.count()),
                      "frames", job.verbosity);
    for (std::int64_t i = 0; i < frames.count(); ++i) {
        throw_if_interrupted("tuning");
        if (!choice.takes(i)) continue;
        Frame frame = frames.read(i);
        if (frame.status != FrameStatus::ok) {
            job.plan.warn(fmt::format("frame {} is left out: {}", frame.index, frame.message));
            continue;
        }
        look.surveys.push_back(surveyor.look(frame));
        look.previews.push_back(
            preview_of(std::move(frame), look.surveys.back(), tracker.info().diameter));
        progress.advance();
    }
    return look;
}

/// The frames with what was found, and the residual of each.
std::vector<Results> runs_of(const Look& look, const TrajectoryInfo& info, double particles_mean,
                             const Job& job) {
    Results seen;
    seen.source = info;
    seen.identity = identity_of(info);
    seen.label = "frames";
    seen.frames = static_cast<std::int64_t>(look.surveys.size());
    seen.particles_mean = particles_mean;
    seen.previews = look.previews;
    Results left = seen;
    left.label = "residual: image − model";
    for (std::size_t i = 0; i < look.surveys.size(); ++i) {
        left.previews[i].frame.image = look.surveys[i].residual;
        // Discs would cover it.
        left.previews[i].snapshot.position.clear();
        left.previews[i].abs_q4.clear();
    }
    return {page_run(std::move(seen), job), page_run(std::move(left), job)};
}

/// The settings that choose another candidate, and what speaks against the one taken.
void add_others(const tracking::Tracker& tracker, const TuneJobOptions& options,
                const std::optional<SizeAdvice>& advice, report::ReportAdditions& additions) {
    for (report::CopyBlock& block :
         candidate_blocks(tracker.weighed(), options.tracking, options.film, tracker.model())) {
        block.title = "Instead: " + block.title;
        additions.blocks.push_back(std::move(block));
    }
    if (advice) additions.verdict = "Another size fits better: " + advice->words;
}

}  // namespace

void plan_tuning(const TuneJobOptions& options, Job& job) {
    job.inputs = io::recording_files(job.inputs);
    tracking::TrackOptions tracking = options.tracking;
    tracking.threads = job.threads;
    tracking.corrects_bias = false;
    const Film film = open_film(job, options.film, tracking);
    tracking.visible = film.visible;
    const tracking::Tracker tracker(*film.frames, tracking, job.plan);
}

TuneJobResult run_tuning(const TuneJobOptions& options, Job& job) {
    const fs::path settings_file = fs::path(options.output).replace_extension(".toml");
    { const OutputFile checked(settings_file, job.overwrite); }  // refused before the work
    job.inputs = io::recording_files(job.inputs);
    tracking::TrackOptions tracking = options.tracking;
    tracking.threads = job.threads;
    tracking.corrects_bias = false;
    const Film film = open_film(job, options.film, tracking);
    tracking.visible = film.visible;
    const tracking::Tracker tracker(*film.frames, tracking, job.plan);
    if (!tracker.is_calibrated() && tracker.weighed().empty()) {
        throw InputError(
            {.problem = fmt::format("nothing to tune on in '{}'", job.inputs.front().string()),
             .actual = job.plan.warnings().empty() ? "no spheres were found"
                                                   : job.plan.warnings().back().text,
             .expected = "a frame with spheres",
             .suggestion = "try calibrate.disc-diameter and calibrate.polarity"});
    }
    report::ReportOptions drawn = options.report;
    drawn.observables = false;  // one frame each: nothing is analysed
    ReportPage page(options.output, drawn, job);
    std::vector<Results> candidates =
        candidate_runs(*film.frames, tracker.weighed_at(), tracker.weighed(), job);
    if (!tracker.is_calibrated()) {
        page.draw(candidates, job, "Which are the spheres?",
                  {.tables = {candidates_table(tracker.weighed())},
                   .figures = {},
                   .verdict = "Not clear: choose a picture and copy its settings",
                   .blocks = candidate_blocks(tracker.weighed(), options.tracking, options.film,
                                              std::nullopt)});
        page.commit(job);
        TuneJobResult undecided;
        undecided.weighed = tracker.weighed();
        return undecided;
    }
    const Look look = look_at(options, tracking, *film.frames, tracker, job);
    const Tuning tuning{tracker.model(), tracking, look.surveys};
    std::optional<SizeAdvice> advice = advice_on(tracker.model(), tracker.weighed());
    if (advice && job.plan.wording()) advice->words = job.plan.wording()(advice->words);
    TuneJobResult result{.frames = static_cast<std::int64_t>(look.surveys.size()),
                         .particles_mean = tuning.particles_mean(),
                         .residual_rms = tuning.residual_rms(),
                         .diameter = tracker.model().disc.diameter,
                         .edge_width = tracker.model().disc.edge_width,
                         .settings = advice ? settings_instead(tuning, options.film, advice->better)
                                            : suggested_settings(tuning, options.film),
                         .settings_file = settings_file,
                         .weighed = tracker.weighed(),
                         .advice = advice ? advice->words : std::string()};
    std::vector<Results> runs = runs_of(look, tracker.info(), result.particles_mean, job);
    std::ranges::move(candidates, std::back_inserter(runs));
    report::ReportAdditions additions =
        tuning_report(tuning, result.settings,
                      options.in_words ? options.in_words(result.settings) : std::string());
    if (!look.surveys.empty()) {
        // About the size that the settings are of.
        additions.alternatives =
            tuned_alternatives(look.previews.front().frame,
                               advice ? advice->better.polarity : tracker.model().polarity,
                               advice ? advice->better.diameter : tracker.model().disc.diameter,
                               look.surveys.front().found.evidence, tracking, options.film, job);
    }
    additions.tables.push_back(candidates_table(tracker.weighed()));
    add_others(tracker, options, advice, additions);
    page.draw(runs, job, "Settings of the tracker", additions);
    write_file(result.settings_file, toml_of(result.settings), job.overwrite);
    page.commit(job);
    job.outputs.push_back(result.settings_file);
    return result;
}

}  // namespace grainfield::pipelines
