#include "app/analyze_command.h"

#include <fmt/format.h>

#include "analysis/density/synthetic_result.h"
#include "analysis/order/bond_order.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/sk_observable.h"
#include "analysis/statistics/run_series.h"
#include "app/interrupt_deadline.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/file_kind.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "io/output_file.h"
#include "io/text/points_csv.h"
#include "io/text/wavevector_csv.h"
#include "pipelines/analyze/lengths.h"
#include "pipelines/field/field_results.h"
#include "report/page/text.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Measurement& m) {
    ordered_json object;
    object["name"] = m.name;
    object["unit"] = m.unit.text();
    if (m.value) object["value"] = *m.value;
    if (m.error) object["error"] = *m.error;
    object["samples"] = m.samples;
    if (!m.reason.empty()) object["reason"] = m.reason;
    return object;
}

// The first measurement stands for the observable; all of them are under "measurements".
ordered_json to_json(const ObservableResult& observable) {
    ordered_json object;
    if (!observable.measurements.empty()) object = to_json(observable.measurements.front());
    if (!observable.reason.empty()) object["reason"] = observable.reason;
    object["seconds"] = observable.seconds;
    object["measurements"] = ordered_json::array();
    for (const Measurement& m : observable.measurements) {
        object["measurements"].push_back(to_json(m));
    }
    return object;
}

std::string words(const Measurement& m, TimeUnit time_unit) {
    const std::string unit = typeset_text(m.unit, time_unit);
    std::string text = fmt::format("    {:<18} ", m.name);
    if (m.value) text += report::with_error(*m.value, m.error ? &*m.error : nullptr);
    if (m.value && !unit.empty()) text += " " + unit;
    if (!m.reason.empty()) text += fmt::format("{}({})", m.value ? " " : "- ", m.reason);
    return text + "\n";
}

std::string words(const Session& session, const Results& results) {
    std::string text =
        fmt::format("{}: {}, {:.1f} particles per frame\n", session.outputs.front().string(),
                    counted(results.frames, "frame"), results.particles_mean);
    for (const ObservableResult& observable : results.observables) {
        const std::string name =
            observable.name == "q4" ? report::order_symbol(results) : observable.name;
        text += fmt::format("  {} ({})\n", name, format_duration(observable.seconds));
        if (!observable.reason.empty()) text += fmt::format("    - ({})\n", observable.reason);
        for (const Measurement& m : observable.measurements) {
            text += words(m, results.source.time_unit);
        }
    }
    for (const PlannedStage& stage : session.plan.skipped()) {
        text += fmt::format("  skipped    {}: {}\n", stage.stage, stage.reason);
    }
    return text;
}

ordered_json facts(const Results& results) {
    ordered_json facts;
    facts["frames"] = results.frames;
    facts["particles_mean"] = results.particles_mean;
    for (const ObservableResult& observable : results.observables) {
        facts[observable.name] = to_json(observable);
    }
    return facts;
}

// The frames that the tracker kept; where there are none, the last snapshot alone.
std::vector<Preview> previews(SnapshotSource& file, pipelines::AdjustedSnapshots& snapshots) {
    if (const auto* trajectory = dynamic_cast<const io::TrajectoryFile*>(&file)) {
        if (!trajectory->previews().empty()) return trajectory->previews();
    }
    if (snapshots.count() == 0) return {};
    Preview last;
    last.snapshot = snapshots.read(snapshots.count() - 1);
    last.frame.index = last.snapshot.frame;
    last.frame.time = last.snapshot.time;
    return {last};
}

}  // namespace

std::string AnalyzeCommand::purpose() const {
    return "measure order, phases, motion and density fluctuations";
}

Command::Inputs AnalyzeCommand::inputs() const {
    return {.placeholder = "TRACKS.h5|POINTS.csv|FIELD.h5",
            .meaning = "a trajectory, a table of points of any tracker, or a field file",
            .count = Count::one};
}

std::vector<OptionTable> AnalyzeCommand::options() {
    OptionTable own("");
    own.text("output", output_, "results file to write");
    own.text(
        "label", label_,
        "name in plots; by default origin and control parameter if known, else the input's name");
    own.number("gamma", gamma_, "-", {0, 1e6},
               "acceleration of the vibration, A omega^2/g; auto: as the simulation says");
    own.text("box", box_, "box of the points as LX,LY in their length unit");
    own.choice("boundary", boundary_,
               {{"as-in-file", BoundaryChoice::as_in_file},
                {"periodic", BoundaryChoice::periodic},
                {"walls", BoundaryChoice::walls}},
               "what the sides of the box are");
    own.text("wavevectors", wavevectors_,
             "table kx,ky of wavevectors in 1/a at which S(k) is measured besides its grid");
    own.number("fps", fps_, "1/s", {1e-9, 1e9}, "frame rate; auto: as the file says");
    own.number("sphere-diameter", particle_diameter_, "length unit of the file", {1e-9, 1e9},
               "true diameter a of a particle, the unit of the results; auto: as the file says");
    own.also_called("diameter");
    own.flag("from-fields", from_fields_,
             "of a field file: measure the stored fields, not what the run accumulated");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : analysis::describe(analysis_)) tables.push_back(std::move(table));
    return tables;
}

// Origin and control parameter where they are known, else the name of the file.
std::string AnalyzeCommand::label_of(const Results& results,
                                     const std::filesystem::path& input) const {
    if (!label_.empty()) return label_;
    return results.identity.control ? legend_of(results.identity) : input.stem().string();
}

pipelines::Adjustment AnalyzeCommand::adjustment() const {
    pipelines::Adjustment adjustment;
    if (!box_.empty()) adjustment.box_length = pipelines::parse_box_length(box_);
    if (boundary_ == BoundaryChoice::periodic) adjustment.boundary = Boundary::periodic;
    if (boundary_ == BoundaryChoice::walls) adjustment.boundary = Boundary::walls;
    adjustment.frame_rate = fps_;
    adjustment.particle_diameter = particle_diameter_;
    adjustment.acceleration = gamma_;
    return adjustment;
}

Summary AnalyzeCommand::run_fields(Session& session) const {
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    const std::filesystem::path& input = session.inputs.front();
    std::optional<io::OutputFile> output;
    if (!session.common.explain) output.emplace(output_, overwrite);
    Results results = pipelines::field_results(
        input, from_fields_,
        {analysis_.of<analysis::StructureFactorOptions>(), analysis_.of<analysis::FitOptions>(),
         analysis_.of<analysis::SyntheticOptions>()},
        session);
    if (session.common.explain) return explanation(session.plan);
    results.record = session.record();
    results.label = label_of(results, input);
    io::write_results(std::move(*output), results);
    session.outputs.push_back(output_);
    return {.text = words(session, results), .facts = facts(results), .signal = 0};
}

Summary AnalyzeCommand::run(Session& session) {
    return run_or_discard("analysis", output_, [&] { return work(session); });
}

Summary AnalyzeCommand::work(Session& session) const {
    require_output(session, output_);
    require_hdf5_name(output_);
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    const std::filesystem::path& input = session.inputs.front();
    const io::FileKind kind = io::identify(input);
    if (kind == io::FileKind::field) {
        if (!wavevectors_.empty()) {
            throw OptionError({.problem = "fields have no S(k) at listed wavevectors",
                               .actual = fmt::format("--wavevectors {}", wavevectors_),
                               .expected = "a trajectory or a table of points",
                               .suggestion =
                                   "leave the option out: the modes of the lattice are all "
                                   "that a field has"});
        }
        return run_fields(session);
    }
    analysis::AnalysisOptions options = analysis_;
    if (!wavevectors_.empty()) {
        options.of<analysis::ListedWavevectors>().k = io::read_wavevectors(wavevectors_);
    }
    if (kind == io::FileKind::points && boundary_ == BoundaryChoice::periodic && box_.empty() &&
        !io::states_box(input)) {
        throw OptionError({.problem = "a periodic boundary needs the box",
                           .actual = fmt::format("'{}' does not say it, and the extent of the "
                                                 "points is smaller than the period",
                                                 input.string()),
                           .expected = "--box LX,LY",
                           .suggestion = "give the periods in the unit of the positions"});
    }
    std::optional<io::OutputFile> output;
    if (!session.common.explain) output.emplace(output_, overwrite);
    const pipelines::Adjustment adjustment = this->adjustment();
    TrajectoryInfo hints;
    adjustment.apply_to(hints);
    std::optional<Box> box;
    if (adjustment.box_length) box = Box{.origin = {}, .length = *adjustment.box_length};
    if (box && adjustment.boundary) box->boundary = {*adjustment.boundary, *adjustment.boundary};
    const auto file = io::open_snapshots(input, box, hints);
    pipelines::AdjustedSnapshots snapshots(*file, adjustment);
    if (const auto* tracks = dynamic_cast<const io::TrajectoryFile*>(file.get());
        tracks != nullptr) {
        for (const Warning& warning : tracks->record().warnings) {
            const bool is_apparent =
                warning.code == WarningCode::apparent_diameter && !particle_diameter_;
            if (is_apparent || warning.code == WarningCode::incomplete) session.plan.warn(warning);
        }
    }
    if (session.common.explain) {
        analysis::plan_measurement(snapshots, options, session.plan);
        return explanation(session.plan);
    }

    Progress progress("analysing", snapshots.count(), "frames", session.common.verbosity());
    Results results = analysis::measure(
        snapshots, options,
        {.threads = session.threads(), .plan = &session.plan, .progress = &progress});
    progress.finish();
    results.identity = identity_of(results.source);
    results.observables.insert(results.observables.begin(),
                               pipelines::lengths_of(*file, results.source, adjustment));
    if (const auto* tracks = dynamic_cast<const io::TrajectoryFile*>(file.get())) {
        if (!tracks->record().command.empty()) results.sources = {tracks->record()};
        if (!tracks->curves().empty()) {
            results.observables.push_back(analysis::run_series(tracks->curves()));
        }
    }
    results.previews = previews(*file, snapshots);
    for (Preview& preview : results.previews) {
        preview.abs_q4 = analysis::abs_q4(preview.snapshot, results.source.diameter,
                                          analysis_.of<analysis::BondOrderOptions>());
    }
    if (results.frames == 0 || results.particles_mean == 0) {
        session.plan.warn(fmt::format("'{}' has no particles", input.string()));
    }
    results.record = session.record();
    results.label = label_of(results, input);
    throw_if_interrupted("analysis");
    io::write_results(std::move(*output), results);
    session.outputs.push_back(output_);
    return {.text = words(session, results), .facts = facts(results), .signal = 0};
}

}  // namespace grainfield::app
