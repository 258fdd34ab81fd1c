#include "pipelines/run/run_job.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/input_record.h"
#include "io/joined_films.h"
#include "pipelines/configuration.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/lab.h"
#include "pipelines/overlay/overlay_job.h"
#include "pipelines/page/report_page.h"
#include "pipelines/track/stored_bias.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
    std::error_code unreachable;
    return fs::exists(path, unreachable);
}

Configuration options_of_tracking(const TrackJobOptions& options) {
    TrackJobOptions copy = options;
    std::vector<OptionTable> tables{OptionTable("")};
    describe(copy.film, tables.front());
    tables.front().integer("previews", copy.previews, "-", {}, "");
    for (OptionTable& table : tracking::describe(copy.tracking)) tables.push_back(std::move(table));
    Configuration configuration = physics_of(tables);
    if (!options.camera.empty()) {
        configuration.emplace_back("camera", io::describe_input(options.camera).checksum);
    }
    // Their names are among the options; a picture of the same name may hold something else.
    std::vector<std::string> files = pictures_of(options.film);
    if (!options.calibration.empty()) files.push_back(options.calibration);
    for (const std::string& file : files) {
        configuration.emplace_back(fmt::format("content of '{}'", file),
                                   io::describe_input(file).checksum);
    }
    return configuration;
}

Configuration options_of_analysis(const AnalyzeJobOptions& options) {
    AnalyzeJobOptions copy = options;
    std::vector<OptionTable> tables{OptionTable("")};
    tables.front().text("label", copy.label, "");
    tables.front().number("gamma", copy.adjustment.acceleration, "-", {}, "");
    for (OptionTable& table : analysis::describe(copy.analysis)) tables.push_back(std::move(table));
    return physics_of(tables);
}

/// A stage as a job of its own, which the records of its output are made from.
Job stage_of(const Job& job, const char* command, std::vector<fs::path> inputs,
             Configuration configuration) {
    Job stage;
    stage.command = command;
    stage.inputs = std::move(inputs);
    stage.configuration = std::move(configuration);
    stage.threads = job.threads;
    stage.seed = job.seed;
    stage.verbosity = job.verbosity;
    stage.size_check = job.size_check;
    stage.overwrite = Overwrite::force;  // what may not be replaced is refused before
    stage.plan = RunPlan(job.plan.wording());
    return stage;
}

/// What the stage planned, skipped, warned of and wrote becomes that of the whole.
void take_over(const Job& stage, Job& job) {
    for (const PlannedStage& planned : stage.plan.stages()) {
        if (planned.runs) {
            job.plan.run(planned.stage, planned.reason);
        } else {
            job.plan.skip(planned.stage, planned.reason, planned.saved);
        }
    }
    for (const Warning& warning : stage.plan.warnings()) job.plan.warn(warning);
    std::ranges::copy(stage.outputs, std::back_inserter(job.outputs));
}

bool same_inputs(const RunRecord& a, const RunRecord& b) {
    return std::ranges::equal(a.inputs, b.inputs, [](const auto& x, const auto& y) {
        return x.bytes == y.bytes && x.checksum == y.checksum;
    });
}

/// Whether a file that has this record would be made again as it is.
bool same_work(const RunRecord& made, const RunRecord& wanted) {
    return made.command == wanted.command && made.version == wanted.version &&
           made.seed == wanted.seed && made.configuration == wanted.configuration &&
           same_inputs(made, wanted);
}

/// Whether a signal ended the work before its end. Without a checkpoint nothing goes on from it.
bool is_cut_off(const RunRecord& made) {
    return std::ranges::any_of(made.warnings, [](const Warning& warning) {
        return warning.code == WarningCode::incomplete;
    });
}

/// The option that differs, for the message.
std::string difference(const RunRecord& made, const RunRecord& wanted) {
    if (!same_inputs(made, wanted)) return "another film";
    if (made.version != wanted.version) return "another version of the program";
    for (const auto& [name, value] : wanted.configuration) {
        const auto known =
            std::ranges::find(made.configuration, name, &Configuration::value_type::first);
        if (known == made.configuration.end()) return name + " was not recorded";
        if (known->second != value) {
            return fmt::format("{} is {}, was {}", name, value, known->second);
        }
    }
    return "other options";
}

/// Γ of the vibration, where the tracks know it.
std::optional<double> gamma_of(const TrajectoryInfo& info) {
    const bool is_known = info.control && info.control->parameter == ControlParameter::acceleration;
    return is_known ? std::optional<double>(info.control->value) : std::nullopt;
}

/// What the tracks say of the lab otherwise than what is given now; empty if they do not. Nothing
/// can be added to tracks that are kept.
std::string lab_difference(const io::TrajectoryFile& tracks, const LabUnits& given) {
    const LabUnits stored = lab_units_in(tracks.curves());
    const auto said = [](const char* what, const std::optional<double>& now,
                         const std::optional<double>& then) -> std::string {
        if (!now || now == then) return {};
        return fmt::format("{} is {:g}, was {}", what, *now,
                           then ? fmt::format("{:g}", *then) : "not given");
    };
    for (const std::string& difference :
         {said("option 'sphere-mm'", given.sphere_mm, stored.sphere_mm),
          said("option 'vibration-frequency'", given.frequency, stored.frequency),
          said("option 'amplitude-mm'", given.amplitude_mm, stored.amplitude_mm),
          said(given.gamma ? "option 'gamma'" : "Γ", given.acceleration(),
               gamma_of(tracks.info()))}) {
        if (!difference.empty()) return difference;
    }
    return {};
}

[[noreturn]] void refuse_to_replace(const fs::path& tracks, const std::string& difference) {
    throw OutputError(
        ErrorText{fmt::format("'{}' holds tracks that were made otherwise", tracks.string()),
                  difference, "the same film and options",
                  "choose another folder, or give option 'force' to replace them"});
}

/// What became of the tracks; nothing if they are there as wanted.
struct Tracked {
    std::optional<TrackJobResult> result;
};

Tracked track(const RunJobOptions& options, const RunFiles& files, Job& job) {
    Job stage = stage_of(job, "track", job.inputs, options_of_tracking(options.track));
    TrackJobOptions track = options.track;
    track.output = files.tracks;
    const fs::path checkpoint = files.tracks.string() + ".checkpoint";
    track.resume.how = "the same command";
    track.resume.resume =
        is_there(checkpoint) && (options.resume || job.overwrite == Overwrite::refuse);
    if (!track.resume.resume && is_there(files.tracks) && job.overwrite == Overwrite::refuse) {
        const io::TrajectoryFile kept(files.tracks);
        RunRecord made = kept.record();
        RunRecord wanted = stage.record();
        if (is_cut_off(made)) {
            // There was no time for checksums: the film is compared by its size.
            for (RunRecord* record : {&made, &wanted}) {
                for (RunRecord::Input& input : record->inputs) input.checksum.clear();
            }
        }
        const bool is_same = same_work(made, wanted);
        if (is_same && !is_cut_off(made)) {
            if (const std::string other = lab_difference(kept, track.lab); !other.empty()) {
                refuse_to_replace(files.tracks, other);
            }
            job.plan.skip("track", "done before, '" + files.tracks.string() + "' is kept", "");
            for (const Warning& warning : made.warnings) job.plan.warn(warning);
            return {};
        }
        if (!is_same) refuse_to_replace(files.tracks, difference(made, wanted));
    }
    stage.overwrite = track.resume.resume ? Overwrite::refuse : Overwrite::force;
    Tracked tracked{track_film(track, stage)};
    take_over(stage, job);
    return tracked;
}

Results analyze(const RunJobOptions& options, const RunFiles& files, Job& job, bool& is_kept) {
    Job stage = stage_of(job, "analyze", {files.tracks}, options_of_analysis(options.analyze));
    if (is_kept && is_there(files.results)) {
        Results made = io::read_results(files.results);
        if (same_work(made.record, stage.record())) {
            job.plan.skip("analyze", "done before, '" + files.results.string() + "' is kept", "");
            return made;
        }
    }
    is_kept = false;
    AnalyzeJobOptions analyze = options.analyze;
    analyze.output = files.results;
    Results results = run_analysis(analyze, stage);
    take_over(stage, job);
    return results;
}

void write_page(const RunJobOptions& options, const RunFiles& files, const Results& results,
                Job& job) {
    Job stage = stage_of(job, "compare", {files.results}, {});
    ReportPage page(files.report, options.report, stage);
    page.draw({results}, stage);
    page.commit(stage);
    take_over(stage, job);
}

/// Gives the signal that cut the drawing short.
int draw(const RunFiles& files, Job& job) {
    Job stage = stage_of(job, "export", {files.tracks}, {});
    OverlayJobOptions overlay;
    overlay.output = files.overlay;
    const int signal = draw_overlay(overlay, stage).signal;
    take_over(stage, job);
    return signal;
}

std::string name_of(const Job& job) {
    const std::string folder = default_folder(job.inputs).string();
    return folder.substr(0, folder.rfind('-'));
}

}  // namespace

RunFiles::RunFiles(const fs::path& folder)
    : tracks(folder / "tracks.h5"),
      results(folder / "results.h5"),
      report(folder / "report.html"),
      overlay(folder / "overlay.mp4") {}

fs::path default_folder(const std::vector<fs::path>& given) {
    std::error_code unreachable;
    if (given.size() == 1 && fs::is_directory(given.front(), unreachable)) {
        const fs::path folder = fs::absolute(given.front() / "").lexically_normal().parent_path();
        return folder.filename().string() + "-results";
    }
    const std::vector<fs::path> film = io::recording_files(given);
    std::string name = film.empty() ? "" : film.front().stem().string();
    if (film.size() > 1) {
        // The part that all pictures share, without the number behind it.
        for (const fs::path& picture : film) {
            const std::string other = picture.stem().string();
            const auto apart = std::ranges::mismatch(name, other);
            name.erase(apart.in1, name.end());
        }
        name.erase(name.find_last_not_of("0123456789_-. ") + 1);
    }
    return (name.empty() ? "film" : name) + "-results";
}

void plan_run(const RunJobOptions& options, Job& job) {
    const RunFiles files(options.folder);
    job.plan.run("folder", options.folder.string());
    Job stage = stage_of(job, "track", job.inputs, options_of_tracking(options.track));
    TrackJobOptions track = options.track;
    track.output = files.tracks;
    plan_tracking(track, stage);
    take_over(stage, job);
    job.plan.run("analyze", "to '" + files.results.string() + "'");
    job.plan.run("report", "to '" + files.report.string() + "'");
    if (options.overlay) {
        job.plan.run("overlay", "to '" + files.overlay.string() + "' if there are two frames");
    } else {
        job.plan.skip("overlay", "--no-overlay", "a video of the film");
    }
}

/// Makes the folder of the results; a run that leaves nothing in it leaves no folder.
class ResultsFolder {
 public:
    /// Throws OutputError if it cannot be made.
    explicit ResultsFolder(const fs::path& folder) : folder_(folder) {
        std::error_code refused;
        is_new_ = fs::create_directories(folder, refused);
        if (refused) {
            throw OutputError(fmt::format("cannot make the folder '{}': {}.", folder.string(),
                                          refused.message()));
        }
    }
    ~ResultsFolder() {
        std::error_code not_empty;
        if (is_new_) fs::remove(folder_, not_empty);
    }
    ResultsFolder(const ResultsFolder&) = delete;
    ResultsFolder& operator=(const ResultsFolder&) = delete;

 private:
    fs::path folder_;
    bool is_new_ = false;
};

RunJobResult run_film(const RunJobOptions& wanted, Job& job) {
    RunJobOptions options = wanted;
    if (options.analyze.label.empty()) options.analyze.label = name_of(job);
    job.inputs = io::recording_files(job.inputs);
    const RunFiles files(options.folder);
    const ResultsFolder folder(options.folder);
    RunJobResult result;
    const Tracked tracked = track(options, files, job);
    bool is_kept = !tracked.result;
    result.stages.push_back({"track", files.tracks, is_kept});
    if (tracked.result && tracked.result->signal != 0) {
        result.signal = tracked.result->signal;
        return result;
    }
    {
        const io::TrajectoryFile tracks(files.tracks);
        result.lab = lab_units_in(tracks.curves());
        result.bias = stored_bias(tracks.curves());
        if (!options.report.sphere_mm) options.report.sphere_mm = result.lab.sphere_mm;
        if (const auto gamma = gamma_of(tracks.info())) {
            options.analyze.adjustment.acceleration = gamma;
            // As the legends of simulations have it: "layer, Γ = 4.7".
            if (wanted.analyze.label.empty()) {
                options.analyze.label += fmt::format(", Γ = {:.4g}", *gamma);
            }
        }
    }
    result.results = run_or_discard("analysis", files.results.string(),
                                    [&] { return analyze(options, files, job, is_kept); });
    result.stages.push_back({"analyze", files.results, is_kept});
    throw_if_interrupted("run");
    // The page is quickly made, and its options may be others.
    run_or_discard("report", files.report.string(),
                   [&] { write_page(options, files, *result.results, job); });
    result.stages.push_back({"report", files.report, false});
    throw_if_interrupted("run");
    if (!options.overlay) {
        job.plan.skip("overlay", "--no-overlay", "a video of the film");
    } else if (result.results->frames < 2) {
        job.plan.skip("overlay", "one frame, which the report shows", "a video of the film");
    } else {
        const bool is_drawn = is_kept && is_there(files.overlay);
        if (!is_drawn) {
            result.signal =
                run_or_discard("overlay", files.overlay.string(), [&] { return draw(files, job); });
        }
        // A film cut short would pass for the whole.
        if (result.signal != 0) fs::remove(files.overlay);
        result.stages.push_back({"overlay", files.overlay, is_drawn});
    }
    return result;
}

}  // namespace grainfield::pipelines
