#include "pipelines/analyze/analyze_job.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/analysis.h"
#include "analysis/density/synthetic_result.h"
#include "analysis/order/bond_order.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/sk_observable.h"
#include "analysis/statistics/run_series.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/file_kind.h"
#include "io/frame_range.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "io/selected_snapshots.h"
#include "io/text/points_csv.h"
#include "io/text/wavevector_csv.h"
#include "pipelines/analyze/lengths.h"
#include "pipelines/film/watched_frames.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

void require_possible(const AnalyzeJobOptions& options, const fs::path& input, io::FileKind kind) {
    if (kind == io::FileKind::field && !options.wavevectors.empty()) {
        throw OptionError(
            {.problem = "fields have no S(k) at listed wavevectors",
             .actual = fmt::format("wavevectors '{}'", options.wavevectors.string()),
             .expected = "a trajectory or a table of points",
             .suggestion = "leave them out: the modes of the lattice are all that a field has"});
    }
    const Adjustment& adjustment = options.adjustment;
    if (kind == io::FileKind::points && adjustment.boundary == Boundary::periodic &&
        !adjustment.box_length && !io::states_box(input)) {
        throw OptionError({.problem = "a periodic boundary needs the box",
                           .actual = fmt::format("'{}' does not say it, and the extent of the "
                                                 "points is smaller than the period",
                                                 input.string()),
                           .expected = "option 'box' LX,LY",
                           .suggestion = "give the periods in the unit of the positions"});
    }
}

/// The numbers of a table mean nothing without the unit they are in.
void require_unit(const SnapshotSource& file, const fs::path& path, const Adjustment& adjustment) {
    const bool is_table = dynamic_cast<const io::TrajectoryFile*>(&file) == nullptr;
    if (!is_table || adjustment.particle_diameter || io::states_diameter(path)) return;
    throw OptionError(
        {.problem = fmt::format("'{}' does not say in which unit its points are", path.string()),
         .actual = "plain numbers: pixels, millimetres or diameters",
         .expected = "the diameter of a particle in that unit, option 'sphere-diameter'",
         .suggestion = "give 1 if the positions are in diameters"});
}

/// A trajectory or table of points, as the adjustment says it is.
struct Input {
    std::unique_ptr<SnapshotSource> file;
    std::unique_ptr<io::SelectedSnapshots> selected;
    std::unique_ptr<AdjustedSnapshots> snapshots;
    const io::TrajectoryFile* trajectory = nullptr;  ///< the file, if it is one
};

void say_selection(const io::FrameSelection& selection, std::int64_t count, RunPlan& plan) {
    if (selection.count == count) return;
    const std::int64_t last = selection.first + (selection.count - 1) * selection.step;
    const std::string steps =
        selection.step == 1 ? "" : fmt::format(" in steps of {}", selection.step);
    plan.run("frames", fmt::format("{} of {} snapshots: {} to {}{}, counted from 0",
                                   selection.count, count, selection.first, last, steps));
}

Input open_input(const fs::path& path, const AnalyzeJobOptions& options, RunPlan& plan) {
    const Adjustment& adjustment = options.adjustment;
    TrajectoryInfo hints;
    adjustment.apply_to(hints);
    std::optional<Box> box;
    if (adjustment.box_length) box = Box{.origin = {}, .length = *adjustment.box_length};
    if (box && adjustment.boundary) box->boundary = {*adjustment.boundary, *adjustment.boundary};
    Input input;
    input.file = io::open_snapshots(path, box, hints);
    const io::FrameSelection selection = io::selection_or_none(options.frames, input.file->count());
    say_selection(selection, input.file->count(), plan);
    input.selected = std::make_unique<io::SelectedSnapshots>(*input.file, selection);
    input.snapshots = std::make_unique<AdjustedSnapshots>(*input.selected, adjustment);
    require_unit(*input.file, path, adjustment);
    input.trajectory = dynamic_cast<const io::TrajectoryFile*>(input.file.get());
    return input;
}

/// Warnings of the run that made the trajectory, as far as they hold for its analysis.
void pass_warnings_on(const Input& input, const Adjustment& adjustment, RunPlan& plan) {
    if (input.trajectory == nullptr) return;
    const bool is_simulated = input.trajectory->info().origin == Origin::md;
    for (const Warning& warning : input.trajectory->record().warnings) {
        const bool of_the_run = is_simulated && warning.code == WarningCode::other;
        const bool is_apparent =
            warning.code == WarningCode::apparent_diameter && !adjustment.particle_diameter;
        if (is_apparent || of_the_run || warning.code == WarningCode::incomplete ||
            warning.code == WarningCode::doubtful_heights ||
            warning.code == WarningCode::unscaled_errors) {
            plan.warn(warning);
        }
    }
}

analysis::AnalysisOptions analysis_of(const AnalyzeJobOptions& options) {
    analysis::AnalysisOptions analysis = options.analysis;
    if (!options.wavevectors.empty()) {
        analysis.of<analysis::ListedWavevectors>().k = io::read_wavevectors(options.wavevectors);
    }
    return analysis;
}

/// The frames that the tracker kept; where there are none, snapshots as it would choose them.
std::vector<Preview> previews_of(const Input& input) {
    AdjustedSnapshots& snapshots = *input.snapshots;
    if (snapshots.count() == 0) return {};
    if (input.trajectory != nullptr) {
        std::vector<Preview> kept = input.trajectory->previews();
        std::erase_if(kept, [&](const Preview& preview) {
            return !snapshots.has_read(preview.snapshot.frame);
        });
        for (Preview& preview : kept) {
            snapshots.adjust(preview.snapshot);
            preview.frame.time = preview.snapshot.time;
        }
        if (!kept.empty()) return kept;
    }
    constexpr std::int64_t usual = 3;  // as track keeps by default
    PreviewChoice choice(usual, snapshots.count());
    std::vector<Preview> previews;
    for (std::int64_t i = 0; i < snapshots.count(); ++i) {
        if (!choice.takes(i)) continue;
        Preview preview;
        preview.snapshot = snapshots.read(i);
        preview.frame.index = preview.snapshot.frame;
        preview.frame.time = preview.snapshot.time;
        previews.push_back(std::move(preview));
    }
    return previews;
}

/// Origin and control parameter where they are known, else the name of the file; and the frames.
std::string label_of(const Results& results, const fs::path& input, const std::string& frames) {
    const std::string name =
        results.identity.control ? legend_of(results.identity) : input.stem().string();
    return io::selects_all(frames) ? name : fmt::format("{}, {}", name, io::in_words(frames));
}

Results measure(const AnalyzeJobOptions& options, const fs::path& path, Job& job) {
    const analysis::AnalysisOptions wanted = analysis_of(options);
    const Input input = open_input(path, options, job.plan);
    AdjustedSnapshots& snapshots = *input.snapshots;
    pass_warnings_on(input, options.adjustment, job.plan);
    Progress progress("analysing", snapshots.count(), "frames", job.verbosity);
    Results results = analysis::measure(
        snapshots, wanted, {.threads = job.threads, .plan = &job.plan, .progress = &progress});
    progress.finish();
    for (const std::string& warning : snapshots.warnings()) job.plan.warn(warning);
    results.identity = identity_of(results.source);
    results.observables.insert(results.observables.begin(),
                               lengths_of(*input.file, results.source, options.adjustment));
    add_times(snapshots, results.observables.front());
    if (input.trajectory != nullptr) {
        if (!input.trajectory->record().command.empty()) {
            results.sources = {input.trajectory->record()};
        }
        const bool is_whole = snapshots.count() == input.file->count();
        if (!is_whole && !input.trajectory->curves().empty()) {
            job.plan.skip("series",
                          "its energies and collisions cover the whole run, not these frames", "");
        } else if (!input.trajectory->curves().empty()) {
            ObservableResult series = analysis::run_series(input.trajectory->curves());
            // The table of what a tracker calibrated is no series.
            if (series.reason.empty()) results.observables.push_back(std::move(series));
        }
    }
    results.previews = previews_of(input);
    for (Preview& preview : results.previews) {
        preview.abs_q4 = analysis::abs_q4(preview.snapshot, results.source.diameter,
                                          wanted.of<analysis::BondOrderOptions>());
    }
    if (results.frames == 0 || results.particles_mean == 0) {
        job.plan.warn(fmt::format("'{}' has no particles", path.string()));
    }
    return results;
}

}  // namespace

void plan_analysis(const AnalyzeJobOptions& options, Job& job) {
    const fs::path& path = job.inputs.front();
    const io::FileKind kind = io::identify(path);
    require_possible(options, path, kind);
    if (kind == io::FileKind::field) {
        plan_field_results(path, {options.fields, options.frames}, job.plan);
        return;
    }
    const Input input = open_input(path, options, job.plan);
    pass_warnings_on(input, options.adjustment, job.plan);
    analysis::plan_measurement(*input.snapshots, analysis_of(options), job.plan);
}

Results run_analysis(const AnalyzeJobOptions& options, Job& job) {
    const fs::path path = job.inputs.front();
    const io::FileKind kind = io::identify(path);
    require_possible(options, path, kind);
    OutputFile output(options.output, job.overwrite);
    const analysis::AnalysisOptions& analysis = options.analysis;
    Results results = kind == io::FileKind::field
                          ? field_results(path, {options.fields, options.frames},
                                          {analysis.of<analysis::StructureFactorOptions>(),
                                           analysis.of<analysis::FitOptions>(),
                                           analysis.of<analysis::SyntheticOptions>()},
                                          job)
                          : measure(options, path, job);
    results.record = job.record();
    results.label = options.label.empty() ? label_of(results, path, options.frames) : options.label;
    throw_if_interrupted("analysis");
    io::write_results(std::move(output), results);
    job.outputs.push_back(options.output);
    return results;
}

}  // namespace grainfield::pipelines
