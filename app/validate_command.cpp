#include "app/validate_command.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/figures_folder.h"
#include "app/optics_summary.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/frame_files.h"
#include "io/open_snapshots.h"
#include "io/output_file.h"
#include "pipelines/render/rendered_frames.h"
#include "pipelines/validate/validation_report.h"
#include "pipelines/validate/validation_summary.h"
#include "simulate/md/initial_state.h"
#include "simulate/md/md_simulation.h"

namespace grainfield::app {

namespace {

/// A run in memory, without what no renderer looks at.
class MovingGrains : public pipelines::StoredSnapshots {
 public:
    void write(const Snapshot& snapshot) override {
        Snapshot lean = snapshot;
        lean.spin.clear();
        lean.spin.shrink_to_fit();
        pipelines::StoredSnapshots::write(lean);
    }
};

Snapshot snapshot_of(const simulate::GrainState& state, const simulate::MdOptions& md) {
    Snapshot s;
    const auto side = [](simulate::Side sides) {
        return sides == simulate::Side::walls ? Boundary::walls : Boundary::periodic;
    };
    s.box = {.origin = {},
             .length = {md.cell.length_x, md.cell.length_y},
             .boundary = {side(md.cell.sides_x), side(md.cell.sides_y)},
             .height = md.cell.height};
    for (std::size_t i = 0; i < state.size(); ++i) {
        s.position.push_back({state.position[i].x, state.position[i].y});
        s.z.push_back(state.position[i].z);
        s.velocity.push_back(state.velocity[i]);
        s.id.push_back(state.id[i]);
    }
    return s;
}

OptionError needs(const char* problem, const char* suggestion) {
    return OptionError(
        {.problem = problem, .actual = {}, .expected = {}, .suggestion = suggestion});
}

}  // namespace

ValidateCommand::ValidateCommand() {
    // A crystal patch that melts at its rim in a liquid, walls out of sight; 41 frames a tenth of a
    // period apart.
    md_.cell.grains = 10400;
    md_.cell.length_x = md_.cell.length_y = 104;
    md_.cell.sides_x = md_.cell.sides_y = simulate::Side::walls;
    md_.initial.layout = simulate::InitialLayout::square;
    md_.initial.temperature = 0.1;
    md_.run.periods = 14;
    md_.run.discard = 10;
    md_.run.snapshot_every = 0.1;
    render_.view.scale = 16;
    render_.silhouette.rim = 0.4;
}

std::string ValidateCommand::purpose() const {
    return "track frames whose truth is known and score what was found";
}

Command::Inputs ValidateCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning = "frames that exist, with --truth; by default frames are rendered",
            .count = Count::any};
}

std::vector<OptionTable> ValidateCommand::options() {
    OptionTable own("");
    own.text("output", output_, "HTML page to write; figures go into a folder beside it");
    own.text("title", report_.title, "title of the page");
    own.flag("figures", report_.figures, "write every plot and table as SVG and CSV beside it");
    own.text("trajectory", trajectory_, "render this trajectory instead of running MD");
    own.text("truth", truth_, "true positions in px of the frames given as input");
    own.integer("previews", previews_, "-", {0, 100}, "frames shown in the report");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(md_)) tables.push_back(std::move(table));
    for (OptionTable& table : simulate::describe(render_)) tables.push_back(std::move(table));
    for (OptionTable& table : tracking::describe(tracking_)) tables.push_back(std::move(table));
    tables.push_back(analysis::describe(fit_));
    tables.push_back(describe(thresholds_));
    return tables;
}

ValidateCommand::Scene ValidateCommand::given_scene(Session& session) const {
    if (truth_.empty()) {
        throw needs("frames were given without their truth",
                    "name the true positions with --truth FILE");
    }
    Scene scene;
    scene.frames = io::open_frames(session.inputs, {});
    for (const std::string& warning : scene.frames->warnings()) session.plan.warn(warning);
    const Box frame{.origin = {-0.5, -0.5},
                    .length = {static_cast<double>(scene.frames->width()),
                               static_cast<double>(scene.frames->height())}};
    TrajectoryInfo hints;
    hints.length_unit = LengthUnit::pixel;
    scene.truth = io::open_snapshots(truth_, frame, hints);
    // Images do not say how fast they were taken; the truth may.
    const TrajectoryInfo& known = scene.truth->info();
    if (!scene.frames->frame_rate() && known.frame_rate && known.time_unit == TimeUnit::second) {
        scene.frames = io::open_frames(session.inputs, {.fps = known.frame_rate});
    }
    session.inputs.emplace_back(truth_);
    if (scene.truth->count() != scene.frames->count()) {
        throw InputError({.problem = fmt::format("'{}' does not belong to these frames", truth_),
                          .actual = fmt::format("{} snapshots", scene.truth->count()),
                          .expected = fmt::format("{}, one a frame", scene.frames->count()),
                          .suggestion = "give all frames that the truth was written with"});
    }
    return scene;
}

ValidateCommand::Scene ValidateCommand::rendered_scene(Session& session) const {
    if (!truth_.empty()) {
        throw needs("--truth was given without frames", "name the frames, or leave out --truth");
    }
    Scene scene;
    scene.trajectory = make_trajectory(session);
    if (scene.trajectory->count() == 0 && !session.common.explain) {
        throw InputError({.problem = "nothing to render: the trajectory holds no snapshot",
                          .actual = {},
                          .expected = {},
                          .suggestion = "let run.periods exceed run.discard"});
    }
    const Box box = scene.trajectory->count() > 0
                        ? scene.trajectory->read(0).box
                        : Box{.origin = {},
                              .length = {md_.cell.length_x, md_.cell.length_y},
                              .boundary = {Boundary::walls, Boundary::walls},
                              .height = md_.cell.height};
    auto frames = std::make_unique<pipelines::RenderedFrames>(
        *scene.trajectory, box, render_, session.seed, session.threads, session.plan);
    scene.truth = std::make_unique<pipelines::RenderedTruth>(*frames);
    scene.sphere_diameter = frames->renderer().view().scale();
    scene.vibration_frequency = frames->truth_info().vibration_frequency;
    scene.rendered = frames.get();
    scene.frames = std::move(frames);
    return scene;
}

std::unique_ptr<SnapshotSource> ValidateCommand::make_trajectory(Session& session) const {
    if (!trajectory_.empty()) {
        session.inputs.emplace_back(trajectory_);
        return io::open_snapshots(trajectory_, std::nullopt, {});
    }
    const double frames = std::max(0.0, md_.run.periods - md_.run.discard) / md_.run.snapshot_every;
    pipelines::require_memory(frames * static_cast<double>(md_.cell.grains),
                              pipelines::available_memory());
    // To explain what ray tracing takes, the state that a run would begin with will do.
    const bool is_shown =
        !session.common.explain || render_.optics == simulate::OpticsKind::raytrace;
    simulate::GrainState initial;
    if (is_shown) {
        initial = simulate::make_initial_state(md_, session.seed);
    }
    auto snapshots = std::make_unique<MovingGrains>();
    if (session.common.explain && is_shown) snapshots->write(snapshot_of(initial, md_));
    simulate::MdSimulation simulation(md_, std::move(initial), session.threads, session.plan);
    snapshots->set_info(simulation.info());
    if (session.common.explain) return snapshots;
    Progress progress("simulating", static_cast<std::int64_t>(md_.run.periods), "periods",
                      session.verbosity);
    while (!simulation.is_done()) {
        throw_if_interrupted("validation");
        const double before = simulation.periods_done();
        simulation.run_window(*snapshots);
        progress.advance(static_cast<std::int64_t>(simulation.periods_done() - before));
    }
    return snapshots;
}

Summary ValidateCommand::finish(Session& session, const pipelines::ValidationOutcome& outcome,
                                const tracking::TrackSummary& tracked, io::OutputFile& html,
                                FiguresFolder* figures) const {
    const std::vector<pipelines::ThresholdCheck> checks = pipelines::check(thresholds_, outcome);
    std::vector<Results> runs = outcome.runs;
    for (Results& run : runs) {
        run.record = session.record();
        run.record.skipped.clear();  // the page takes them from the plan
        run.record.warnings.clear();
    }
    report::ReportOptions options = report_;
    options.threads = session.threads;
    if (options.title.empty()) options.title = "Validation of the tracker";
    report::write_report(runs, options, html.temporary(), figures_folder(output_), session.plan,
                         pipelines::validation_report(outcome, checks));
    html.commit();
    session.outputs.push_back(output_);
    if (figures != nullptr) {
        figures->keep();
        session.outputs.push_back(figures->path());
    }
    Summary summary{.text = pipelines::summary_text(output_, outcome, checks),
                    .facts = pipelines::summary_facts(outcome, tracked, checks),
                    .signal = caught_signal(),
                    .failure = {}};
    if (summary.signal == 0) summary.failure = pipelines::missed_thresholds(checks);
    return summary;
}

Summary ValidateCommand::run(Session& session) {
    if (!session.common.explain) require_output(session, output_);
    const Scene scene = session.inputs.empty() ? rendered_scene(session) : given_scene(session);
    if (session.common.explain) {
        if (scene.rendered != nullptr && scene.rendered->count() > 0) {
            explain_rays(scene.rendered->check_sampling(), session.plan);
        }
        session.plan.run("track", "calibrates on the first frame; see 'track --explain'");
        session.plan.run("score", "matched within D/4, against the joint Cramér–Rao bound");
        session.plan.run("analyse", "the true and the tracked positions");
        return explanation(session.plan);
    }
    const auto overwrite = session.overwrite;
    io::OutputFile html(output_, overwrite);
    std::optional<FiguresFolder> figures;
    if (report_.figures) figures.emplace(figures_folder(output_), overwrite);
    pipelines::ValidationSettings settings;
    settings.tracking = tracking_;
    settings.fit = fit_;
    settings.previews = previews_;
    settings.threads = session.threads;
    settings.verbosity = session.verbosity;
    settings.slow_frames =
        scene.rendered != nullptr && render_.optics == simulate::OpticsKind::raytrace;
    tracking::TrackSummary tracked;
    const pipelines::ValidationOutcome outcome =
        validate({*scene.frames, *scene.truth, scene.sphere_diameter, scene.vibration_frequency},
                 settings, tracked, session.plan);
    Summary summary = finish(session, outcome, tracked, html, figures ? &*figures : nullptr);
    if (scene.rendered != nullptr) {
        add_optics_summary(scene.rendered->renderer(), scene.rendered->rendered(),
                           scene.rendered->check_sampling(), summary);
    }
    return summary;
}

}  // namespace grainfield::app
