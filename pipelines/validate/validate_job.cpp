#include "pipelines/validate/validate_job.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/support/interrupt.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/page/report_page.h"
#include "pipelines/track/calibration_file.h"
#include "pipelines/validate/validation_report.h"

namespace grainfield::pipelines {

namespace {

ValidationSettings settings_of(const ValidateJobOptions& options, const ValidationScene& scene,
                               const Job& job) {
    ValidationSettings settings;
    settings.tracking = options.tracking;
    if (!options.calibration.empty())
        settings.tracking.kept = read_calibration(options.calibration);
    settings.fit = options.fit;
    settings.previews = options.previews;
    settings.threads = job.threads;
    settings.verbosity = job.verbosity;
    settings.slow_frames =
        scene.rendered != nullptr && options.scene.render.optics.chosen().samples();
    return settings;
}

}  // namespace

void plan_validation(const ValidateJobOptions& options, Job& job) {
    const ValidationScene scene = plan_scene(options.scene, job);
    if (scene.rendered != nullptr && scene.rendered->count() > 0) {
        plan_rays(scene.rendered->check_sampling(), job.plan);
    }
    if (options.calibration.empty()) {
        job.plan.run("track", "calibrates on the first frame, as a run on the frames would");
    } else {
        read_calibration(options.calibration);
        job.plan.run("track", fmt::format("with the calibration of '{}'", options.calibration));
    }
    job.plan.run("score", "matched within D/4, against the joint Cramér–Rao bound");
    job.plan.run("analyse", "the true and the tracked positions");
}

ValidateJobResult run_validation(const ValidateJobOptions& options, Job& job) {
    // After the first frame a signal leaves the scores of those that are done.
    std::optional<DiscardDeadline> none_done(std::in_place, "validation", options.output);
    const ValidationScene scene = open_scene(options.scene, job);
    ReportPage page(options.output, options.report, job);
    tracking::TrackSummary tracked;
    ValidationSettings settings = settings_of(options, scene, job);
    settings.on_frame = [&] { none_done.reset(); };
    ValidationOutcome outcome =
        validate({*scene.frames, *scene.truth, scene.sphere_diameter, scene.vibration_frequency},
                 settings, tracked, job.plan);
    none_done.reset();
    std::vector<ThresholdCheck> checks = check(options.thresholds, outcome);
    std::vector<Results> runs;
    for (const Results& run : outcome.runs) runs.push_back(page_run(run, job));
    page.draw(runs, job, "Validation of the tracker", validation_report(outcome, checks));
    page.commit(job);
    ValidateJobResult result{.outcome = std::move(outcome),
                             .tracked = tracked,
                             .checks = std::move(checks),
                             .optics = std::nullopt,
                             .signal = caught_signal()};
    if (scene.rendered != nullptr) {
        result.optics = optics_use(scene.rendered->renderer(), scene.rendered->rendered(),
                                   scene.rendered->check_sampling());
    }
    return result;
}

}  // namespace grainfield::pipelines
