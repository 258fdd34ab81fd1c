#include "pipelines/validate/random/random_validation.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/output_file.h"
#include "core/support/parallel.h"
#include "core/support/progress.h"
#include "io/frame_writer.h"
#include "io/images/png_image.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/page/report_page.h"
#include "pipelines/validate/random/random_report.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

const RandomOptics& asked_for(const ValidateJobOptions& options) {
    return options.scene.render.optics.of<RandomOptics>();
}

void require_nothing_given(const ValidateJobOptions& options, const Job& job) {
    if (job.inputs.empty() && options.scene.trajectory.empty() && options.scene.truth.empty()) {
        return;
    }
    throw OptionError({.problem = "random optics draw their scenes",
                       .actual = "frames, a trajectory or a truth were given",
                       .expected = "none of them",
                       .suggestion = "leave them out, or choose the optics of one camera"});
}

/// frame.png, true.csv and optics.toml of a scene, as bench/tracking/traced-frames reads them.
void keep_scene(const SeenScene& scene, const fs::path& folder, Overwrite overwrite) {
    const fs::path own = folder / fmt::format("{:03}", scene.score.index);
    std::error_code failed;
    fs::create_directories(own, failed);
    if (failed) {
        throw OutputError({.problem = fmt::format("cannot make folder '{}'", own.string()),
                           .actual = failed.message(),
                           .expected = {},
                           .suggestion = "choose another place for the frames"});
    }
    const io::PictureShape shape{scene.frame.image.width(), scene.frame.image.height(),
                                 scene.frame.bit_depth};
    OutputFile picture(own / "frame.png", overwrite);
    io::png_format().write(picture.temporary(),
                           io::counts_of(scene.frame, {.format = nullptr,
                                                       .width = shape.width,
                                                       .height = shape.height,
                                                       .bit_depth = shape.bit_depth,
                                                       .fps = {}}),
                           shape);
    picture.commit();
    std::string table = "frame,particle,x,y,z,layer\n";
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
        const Vec2 p = scene.truth.position[i];
        table += fmt::format("0,{},{:.5f},{:.5f},{:.5f},{}\n", scene.truth.id[i], p.x, p.y,
                             scene.truth.z[i], static_cast<int>(scene.truth.layer[i]));
    }
    write_file(own / "true.csv", table, overwrite);
    write_file(own / "optics.toml", toml_of(scene.score.drawn), overwrite);
}

/// The worst scenes so far, at most `most`; which they are does not depend on the order.
class WorstScenes {
 public:
    explicit WorstScenes(int most) : most_(static_cast<std::size_t>(most)) {}

    void offer(SeenScene scene) {
        scenes_.push_back(std::move(scene));
        std::sort(scenes_.begin(), scenes_.end(),
                  [](const auto& a, const auto& b) { return is_worse(a.score, b.score); });
        if (scenes_.size() > most_) scenes_.pop_back();
    }
    const std::vector<SeenScene>& scenes() const { return scenes_; }

 private:
    std::size_t most_;
    std::vector<SeenScene> scenes_;
};

struct SceneSeries {
    std::vector<SceneScore> done;
    WorstScenes worst;
};

SceneSeries see_scenes(const ValidateJobOptions& options, const Job& job) {
    const RandomOptics& random = asked_for(options);
    Progress progress("simulating, rendering and tracking", random.scenes, "scenes", job.verbosity);
    progress.announce();
    SceneSeries series{{}, WorstScenes(options.previews)};
    // After the first scene a signal leaves the scores of those that are done.
    std::optional<DiscardDeadline> none_done(std::in_place, "validation", options.output);
    std::mutex guard;
    parallel_for(random.scenes, job.threads, [&](std::int64_t i) {
        if (caught_signal() != 0) return;
        try {
            SeenScene scene = see_scene(draw_scene(job.seed, i, random.scene_size, random.crystals),
                                        i, options.tracking);
            if (!random.keep.empty()) keep_scene(scene, random.keep, job.overwrite);
            const std::lock_guard lock(guard);
            none_done.reset();
            series.done.push_back(scene.score);
            series.worst.offer(std::move(scene));
            progress.advance();
        } catch (const Interrupted&) {
            // The scenes that are done count.
        }
    });
    std::sort(series.done.begin(), series.done.end(),
              [](const auto& a, const auto& b) { return a.index < b.index; });
    return series;
}

}  // namespace

bool is_random(const ValidateJobOptions& options) {
    return options.scene.render.optics.is(RandomOptics().name());
}

void plan_random_validation(const ValidateJobOptions& options, Job& job) {
    require_nothing_given(options, job);
    const RandomOptics& random = asked_for(options);
    job.plan.run("draw",
                 fmt::format("{} cameras and layers, from seed {}", random.scenes, job.seed));
    job.plan.run("simulate",
                 random.crystals > 0
                     ? fmt::format("40 periods of each layer; {:.0f} % of them begin with "
                                   "a crystal and are pictured in the first ten",
                                   100 * random.crystals)
                     : std::string("40 periods of each layer"));
    job.plan.run("render", "ray-traced, one frame each");
    job.plan.run("track", "calibrates on each frame");
    job.plan.run("score", "matched within D/4, D = 0.88 a");
    job.plan.skip("bounds", "the image models of the cameras are not the tracker's",
                  "the joint Cramér–Rao bound of each frame");
    job.plan.skip("analysis", "one frame a scene", "what the errors do to |Q4|, MSD and S(k)");
}

RandomValidationResult run_random_validation(const ValidateJobOptions& options, Job& job) {
    plan_random_validation(options, job);
    report::ReportOptions drawn = options.report;
    drawn.observables = false;  // nothing is analysed
    ReportPage page(options.output, drawn, job);
    const SceneSeries series = see_scenes(options, job);
    if (series.done.empty()) throw_if_interrupted("validation");
    RandomValidationResult result{.scenes = series.done,
                                  .checks = check(options.random_thresholds, series.done),
                                  .signal = caught_signal()};
    const auto asked = static_cast<std::size_t>(asked_for(options).scenes);
    if (series.done.size() < asked) {
        job.plan.warn(WarningCode::interrupted,
                      fmt::format("interrupted after {} of {} scenes: scores of those",
                                  series.done.size(), asked));
    }
    std::vector<Results> runs;
    for (Results& run : random_runs(series.done, series.worst.scenes())) {
        runs.push_back(page_run(std::move(run), job));
    }
    page.draw(runs, job, "Validation of the tracker: cameras drawn at random",
              random_report(result.scenes, result.checks));
    page.commit(job);
    if (!asked_for(options).keep.empty()) job.outputs.emplace_back(asked_for(options).keep);
    return result;
}

}  // namespace grainfield::pipelines
