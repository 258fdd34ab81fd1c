#include "pipelines/analyze/part_job.h"

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/analysis.h"
#include "analysis/spectra/sk_observable.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/checkpoint_file.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/text/wavevector_csv.h"
#include "pipelines/analyze/lengths.h"
#include "pipelines/configuration.h"
#include "pipelines/track/film_part.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

analysis::AnalysisOptions analysis_of(const AnalyzeJobOptions& options) {
    analysis::AnalysisOptions analysis = options.analysis;
    if (!options.wavevectors.empty()) {
        analysis.of<analysis::ListedWavevectors>().k = io::read_wavevectors(options.wavevectors);
    }
    return analysis;
}

void require_all_frames(const AnalyzeJobOptions& options) {
    if (io::selects_all(options.frames)) return;
    throw OptionError({.problem = "a part of a film is analysed as a whole",
                       .actual = fmt::format("frames '{}'", options.frames),
                       .expected = "no option 'frames' with option 'partial' or option 'merge'",
                       .suggestion = "choose the frames of a part when it is tracked"});
}

/// All that accumulators depend on. What was asked for is stored with them.
Configuration configuration_of(const analysis::AnalysisOptions& analysis) {
    analysis::AnalysisOptions options = analysis;
    Configuration configuration = physics_of(analysis::describe(options));
    std::erase_if(configuration,
                  [](const auto& entry) { return entry.first == "analysis.observables"; });
    for (const Vec2& k : analysis.of<analysis::ListedWavevectors>().k) {
        configuration.emplace_back("wavevector", fmt::format("{},{}", k.x, k.y));
    }
    return configuration;
}

/// A file of accumulators: where its part lies.
struct PartFile {
    fs::path path;
    std::int64_t begin = 0, end = 0, whole = 0;
    std::vector<double> calibration;
};

PartFile place_of(const fs::path& path, const Checkpoint& checkpoint) {
    const auto span = checkpoint.integers.find("span");
    const auto calibration = checkpoint.reals.find("calibration");
    if (span == checkpoint.integers.end() || span->second.size() != 3 ||
        calibration == checkpoint.reals.end()) {
        throw InputError(
            {.problem = fmt::format("'{}' holds no part of an analysis", path.string()),
             .actual = fmt::format("a file of kind '{}'", checkpoint.kind),
             .expected = "the output of 'grainfield analyze --partial'",
             .suggestion = "measure each part with option 'partial' and merge what that writes"});
    }
    return {path, span->second[0], span->second[1], span->second[2], calibration->second};
}

/// In the order of their frames, each frame once.
std::vector<PartFile> checked_files(const std::vector<fs::path>& inputs,
                                    const Configuration& configuration) {
    std::vector<PartFile> files;
    for (const fs::path& path : inputs) {
        const Checkpoint checkpoint = io::read_checkpoint(path, io::CheckpointUse::merge);
        files.push_back(place_of(path, checkpoint));
        io::require_same_configuration(checkpoint, configuration, path, io::CheckpointUse::merge);
        throw_if_interrupted("analysis");
    }
    std::ranges::stable_sort(files, {}, &PartFile::begin);
    std::int64_t next = 0;
    for (const PartFile& file : files) {
        if (file.calibration != files.front().calibration || file.whole != files.front().whole) {
            throw InputError(
                {.problem = fmt::format("'{}' and '{}' are not of one film", file.path.string(),
                                        files.front().path.string()),
                 .actual = "film or calibration differ",
                 .expected = {},
                 .suggestion = "track and analyse all parts alike"});
        }
        if (file.begin != next) {
            throw InputError(
                {.problem = file.begin > next ? "parts of the film are missing" : "parts overlap",
                 .actual = fmt::format("'{}' has frames {} to {}", file.path.string(), file.begin,
                                       file.end - 1),
                 .expected = fmt::format("a part that begins with frame {}", next),
                 .suggestion = "give each part once"});
        }
        next = file.end;
    }
    if (next != files.front().whole) {
        throw InputError({.problem = "parts of the film are missing",
                          .actual = fmt::format("the last, '{}', ends with frame {}",
                                                files.back().path.string(), next - 1),
                          .expected = fmt::format("frames up to {}", files.front().whole - 1),
                          .suggestion = "analyse the other parts, too"});
    }
    return files;
}

}  // namespace

PartJobResult analyze_part(const AnalyzeJobOptions& options, Job& job) {
    require_all_frames(options);
    const fs::path& path = job.inputs.front();
    std::error_code error;
    if (job.overwrite == Overwrite::refuse && fs::exists(options.output, error)) {
        throw OutputError({.problem = fmt::format("'{}' exists", options.output.string()),
                           .actual = {},
                           .expected = {},
                           .suggestion = "choose another name, or set option 'force'"});
    }
    io::TrajectoryFile file(path);
    const std::optional<PartRecord> part = part_record(file, path);
    if (!part) {
        throw InputError(
            {.problem = fmt::format("'{}' is not a part of a film", path.string()),
             .actual = fmt::format("a trajectory of {}", counted(file.count(), "frame")),
             .expected = "the output of 'grainfield track --no-link'",
             .suggestion = "analyse it without option 'partial'"});
    }
    AdjustedSnapshots snapshots(file, options.adjustment);
    for (const Warning& warning : file.record().warnings) {
        if (warning.code != WarningCode::other) job.plan.warn(warning);
    }
    const analysis::AnalysisOptions wanted = analysis_of(options);
    Progress progress("analysing", snapshots.count(), "frames", job.verbosity);
    Checkpoint checkpoint = analysis::measure_part(
        snapshots, {.first = part->span.begin, .whole = part->film.count}, wanted,
        {.threads = job.threads, .plan = &job.plan, .progress = &progress});
    progress.finish();
    for (const std::string& warning : snapshots.warnings()) job.plan.warn(warning);
    checkpoint.configuration = configuration_of(wanted);
    checkpoint.integers["span"] = {part->span.begin, part->span.end, part->film.count};
    checkpoint.reals["calibration"] = part->calibration;
    throw_if_interrupted("analysis");
    io::write_checkpoint(checkpoint, options.output);
    job.outputs.push_back(options.output);
    return {checkpoint.texts["observables"], part->span.begin, part->film.count, file.count()};
}

Results merge_parts(const AnalyzeJobOptions& options, Job& job) {
    require_all_frames(options);
    if (options.adjustment != Adjustment{}) {
        throw OptionError({.problem = "parts are merged as they were measured",
                           .actual = "a diameter, rate, box, boundary or acceleration is given",
                           .expected = "none of these with option 'merge'",
                           .suggestion = "give it with option 'partial', for each part"});
    }
    OutputFile output(options.output, job.overwrite);
    const analysis::AnalysisOptions wanted = analysis_of(options);
    const std::vector<PartFile> files = checked_files(job.inputs, configuration_of(wanted));
    std::size_t next = 0;
    Results results = analysis::merged(
        [&]() -> std::optional<Checkpoint> {
            throw_if_interrupted("analysis");
            if (next == files.size()) return std::nullopt;
            return io::read_checkpoint(files[next++].path, io::CheckpointUse::merge);
        },
        wanted, {.threads = job.threads, .plan = &job.plan});
    job.plan.run("merge",
                 fmt::format("{} of {}", counted(static_cast<std::int64_t>(files.size()), "part"),
                             counted(results.frames, "frame")));
    job.plan.skip("previews", "parts of an analysis hold no pictures", "");
    results.identity = identity_of(results.source);
    results.observables.insert(results.observables.begin(), lengths_of(results.source, {}));
    results.record = job.record();
    results.label = options.label;
    if (results.label.empty()) {
        results.label = results.identity.control ? legend_of(results.identity)
                                                 : fs::path(results.source.source).stem().string();
    }
    throw_if_interrupted("analysis");
    io::write_results(std::move(output), results);
    job.outputs.push_back(options.output);
    return results;
}

}  // namespace grainfield::pipelines
