#include "app/track_command.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "app/bias_summary.h"
#include "core/errors.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using pipelines::TrackJobResult;

std::string synthesis_in_words(const tracking::SynthesisSummary& found) {
    if (found.frames == 0) return "";
    return fmt::format(
        "  synthesis  residual {:.4f} → {:.4f} of the contrast; {} added, {} removed, {} moved; {} "
        "of {} positions doubtful\n"
        "  heights    {} of {} known to {:.1f} a\n"
        "  optics     {}\n",
        found.mean_before(), found.mean_after(), found.added, found.removed, found.lifted,
        found.doubtful, found.spheres, found.heights_known, found.spheres,
        tracking::kMostHeightError, in_words(found.optics, found.optics_error));
}

ordered_json synthesis_facts(const tracking::TrackSummary& summary) {
    const tracking::SynthesisSummary& found = summary.synthesis;
    if (found.frames == 0) return nullptr;
    const tracking::MirrorOptics& optics = found.optics;
    const tracking::OpticsErrors& error = found.optics_error;
    return {{"frames", found.frames},
            {"residual_before", found.mean_before()},
            {"residual_rms", found.mean_after()},
            {"positions", found.spheres},
            {"added", found.added},
            {"removed", found.removed},
            {"moved", found.lifted},
            {"doubtful", found.doubtful},
            {"heights_known", found.heights_known},
            {"frames_doubtful", found.doubtful_frames},
            {"frames_not_converged", found.risen_frames},
            {"frames_unexplained", found.unexplained_frames},
            {"frames_unscaled_errors", found.unscaled_frames},
            {"optics",
             {{"reflectivity", optics.reflectivity},
              {"reflectivity_std", error.reflectivity},
              {"blur_a", optics.blur},
              {"blur_std_a", error.blur},
              {"ambient", optics.ambient},
              {"ambient_std", error.ambient},
              {"grazing", optics.grazing},
              {"grazing_std", error.grazing},
              {"camera_distance_a", optics.distance}}},
            {"ms_per_frame", summary.ms_per_frame.synthesis}};
}

ordered_json candidate_facts(const std::vector<tracking::SizeCandidate>& weighed) {
    ordered_json facts = ordered_json::array();
    for (const tracking::SizeCandidate& candidate : weighed) {
        facts.push_back(
            {{"polarity", candidate.polarity == tracking::Polarity::dark ? "dark" : "bright"},
             {"diameter_px", candidate.diameter},
             {"edge_width_px", candidate.edge_width},
             {"explained", candidate.explained.signal},
             {"explained_charged", candidate.explained.charged},
             {"positions", candidate.spheres}});
    }
    return facts;
}

std::string camera_in_words(const TrackJobResult& result) {
    if (!result.camera) return "";
    const tracking::Camera& camera = *result.camera;
    std::string text = "  camera     positions are corrected for lens and tilt";
    if (camera.scale) {
        text += fmt::format("; 1 px is {:.5g} {}", camera.scale->length,
                            camera.scale->unit == tracking::PlaneUnit::mm ? "mm" : "a");
    }
    return text + fmt::format("; residual {:.3f} px\n", camera.residual_rms);
}

std::string words(const Session& session, const TrackJobResult& result, const LabUnits& lab) {
    const tracking::TrackSummary& summary = result.summary;
    std::string text =
        fmt::format("{}: {}, {} particles per frame\n", session.outputs.front().string(),
                    counted(summary.frames, "frame"), mean_text(summary.particles_mean));
    if (const std::int64_t bad = summary.frames_corrupt + summary.frames_missing; bad > 0) {
        text += fmt::format("  left out   {}: {} corrupt, {} missing\n", counted(bad, "frame"),
                            summary.frames_corrupt, summary.frames_missing);
    }
    if (const auto& spheres = result.spheres) {
        text += fmt::format("  spheres    {}, diameter {:.3f} px, edge width {:.3f} px\n",
                            spheres->polarity == tracking::Polarity::dark ? "dark" : "bright",
                            spheres->diameter, spheres->edge_width);
        if (spheres->binning > 1) {
            text += fmt::format(
                "  pixels     fitted by blocks of {0} x {0} (--binning 1: one by one)\n",
                spheres->binning);
        }
    }
    text += pipelines::units_in_words(result.info, result.rate_source, lab, session.plan);
    text += camera_in_words(result);
    if (result.weighed.size() > 1) {
        text += "  weighed    " + tracking::in_words(result.weighed) + "\n";
    }
    if (result.has_residual()) {
        text += fmt::format("  residual   {:.4f} of the contrast (RMS), noise {:.4f}\n",
                            summary.residual_rms, summary.noise);
    }
    if (summary.layers.spheres > 0) {
        text += fmt::format("  layers     {}; {} left out as impossible\n",
                            tracking::in_words(summary.layers),
                            summary.layers.rejected_pairs + summary.layers.rejected_triples);
    }
    // Why there is none stands with what was skipped.
    if (result.bias && result.bias->source != tracking::BiasSource::none) {
        text += fmt::format("  bias       positions {}\n", in_words(*result.bias));
    }
    if (summary.strict_frames + summary.mended > 0) {
        text += fmt::format(
            "  room       of {} frames {} take spheres that explain little for false, as most have "
            "no room; one sphere for two in {} places\n",
            summary.frames, summary.strict_frames, summary.mended);
    }
    text += synthesis_in_words(summary.synthesis);
    const auto& ms = summary.ms_per_frame;
    const std::string synthesis =
        summary.synthesis.frames > 0 ? fmt::format("synthesis {:.1f}, ", ms.synthesis) : "";
    text += fmt::format(
        "  time       {:.1f} ms a frame{} read {:.1f}, detect {:.1f}, refine {:.1f}, {}link "
        "{:.1f}, "
        "write {:.1f}; {} in all\n",
        ms.wall, summary.frames > 1 ? ", two side by side; of each" : ":", ms.read, ms.detect,
        ms.refine, synthesis, ms.link, ms.write, format_duration(session.seconds()));
    const auto& work = summary.work_per_frame;
    text += fmt::format(
        "  work       of each frame {:.1f} updates a sphere, {:.1f} joint steps, {:.0f} trials of "
        "another sphere, {:.1f} kept\n",
        work.disc_updates / std::max(1.0, work.discs), work.joint_steps, work.trials,
        work.trials_kept);
    for (const PlannedStage& stage : session.plan.skipped()) {
        text += fmt::format("  skipped    {}: {}\n", stage.stage, stage.reason);
    }
    return text;
}

ordered_json known(const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json();
}

/// Frame rate, scale and vibration, and where they come from.
void add_units(ordered_json& facts, const TrackJobResult& result, const LabUnits& lab) {
    using pipelines::RateSource;
    const TrajectoryInfo& info = result.info;
    const bool is_apparent = info.diameter_origin == DiameterOrigin::apparent;
    facts["frame_rate"] = known(info.frame_rate);
    facts["frame_rate_source"] = result.rate_source == RateSource::given  ? "given"
                                 : result.rate_source == RateSource::file ? "file"
                                 : result.rate_source == RateSource::live ? "live"
                                                                          : "unknown";
    facts["sphere_px"] = info.diameter;
    facts["sphere_px_source"] = is_apparent ? "apparent" : "given";
    facts["sphere_mm"] = known(lab.sphere_mm);
    facts["camera"] = nullptr;
    if (result.camera) facts["camera"] = {{"residual_px", result.camera->residual_rms}};
    facts["gamma"] = info.control ? ordered_json(info.control->value) : ordered_json();
    facts["vibration_frequency_hz"] = known(lab.frequency);
    facts["amplitude_mm"] = known(lab.amplitude_mm);
}

ordered_json facts(const TrackJobResult& result, const LabUnits& lab) {
    const tracking::TrackSummary& summary = result.summary;
    ordered_json facts;
    facts["frames"] = summary.frames;
    facts["frames_corrupt"] = summary.frames_corrupt;
    facts["frames_missing"] = summary.frames_missing;
    facts["particles_mean"] = summary.particles_mean;
    facts["diameter_px"] = nullptr;
    facts["edge_width_px"] = nullptr;
    facts["binning"] = nullptr;
    facts["binning_reason"] = nullptr;
    if (result.spheres) {
        facts["diameter_px"] = result.spheres->diameter;
        facts["edge_width_px"] = result.spheres->edge_width;
        facts["binning"] = result.spheres->binning;
        facts["binning_reason"] = result.spheres->binning_reason;
    }
    add_units(facts, result, lab);
    facts["candidates"] = candidate_facts(result.weighed);
    const auto& ms = summary.ms_per_frame;
    facts["ms_per_frame"] = {{"detect", ms.detect}, {"refine", ms.refine}, {"link", ms.link},
                             {"read", ms.read},     {"write", ms.write},   {"wall", ms.wall}};
    const auto& work = summary.work_per_frame;
    facts["work_per_frame"] = {{"discs", work.discs},
                               {"disc_updates", work.disc_updates},
                               {"joint_steps", work.joint_steps},
                               {"gain_maps", work.gain_maps},
                               {"trials", work.trials},
                               {"trials_kept", work.trials_kept}};
    facts["room"] = {{"strict_frames", summary.strict_frames}, {"mended", summary.mended}};
    facts["residual_rms"] = nullptr;
    if (result.has_residual()) facts["residual_rms"] = summary.residual_rms;
    facts["layers"] = nullptr;
    if (summary.layers.spheres > 0) {
        const auto& layers = summary.layers;
        facts["layers"] = {{"labelled", layers.labelled},
                           {"bottom", layers.labelled - layers.top},
                           {"top", layers.top},
                           {"unknown", layers.spheres - layers.labelled},
                           {"positions", layers.spheres},
                           {"contradictory", layers.contradictory},
                           {"rejected_pairs", layers.rejected_pairs},
                           {"rejected_triples", layers.rejected_triples}};
    }
    facts["bias"] = result.bias ? bias_facts(*result.bias) : ordered_json();
    facts["synthesis"] = synthesis_facts(summary);
    facts["unsettled"] = summary.unsettled;
    facts["rejected"] = summary.rejected;
    facts["warm_frames"] = summary.warm_frames;
    facts["repeated_frames"] = summary.repeated;
    facts["contrast_range"] = {summary.dimmest, summary.brightest};
    return facts;
}

/// What is said of the source of a live run.
std::string live_in_words(const pipelines::LiveJobResult& result) {
    const io::LiveCounts& counts = result.counts;
    std::string text = fmt::format("  live       {} came", counted(counts.arrived, "frame"));
    if (counts.captured != counts.arrived) text += fmt::format(", {} wanted", counts.captured);
    text += fmt::format(", {} dropped", counts.dropped);
    if (result.untracked > 0) text += fmt::format(", {} not waited for", result.untracked);
    if (counts.rate() > 0) text += fmt::format("; {:.4g} a second", counts.rate());
    return text + (result.signal != 0       ? "; ended by a signal\n"
                   : result.is_silent       ? "; the source fell silent\n"
                   : !counts.damage.empty() ? "; the source broke off\n"
                                            : "; the source ended\n");
}

ordered_json live_facts(const pipelines::LiveJobResult& result) {
    const io::LiveCounts& counts = result.counts;
    return {{"frames_arrived", counts.arrived},
            {"frames_captured", counts.captured},
            {"frames_dropped", counts.dropped},
            {"frames_untracked", result.untracked},
            {"seconds", counts.seconds},
            {"damage", counts.damage.empty() ? ordered_json() : ordered_json(counts.damage)},
            {"signal", result.signal}};
}

/// The first of the options that only a live source has and that has another value than by itself.
std::string first_live_option(const pipelines::LiveJobOptions& live) {
    pipelines::LiveJobOptions given = live;
    pipelines::LiveJobOptions usual;
    usual.source = given.source;
    OptionTable table(""), as_usual("");
    describe(given, table);
    describe(usual, as_usual);
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        const Option& row = table.rows()[i];
        if (to_text(row.get()) != to_text(as_usual.rows()[i].get())) return row.name;
    }
    return {};
}

/// Throws OptionError where neither a film nor a live source is given, or live options without one.
void require_film(const Session& session, const pipelines::LiveJobOptions& live) {
    if (session.inputs.empty()) {
        throw OptionError({.problem = "'track' has no input",
                           .actual = {},
                           .expected = "at least one VIDEO|IMAGE, or a live source (option 'live')",
                           .suggestion = "see 'grainfield track --help'"});
    }
    if (const std::string given = first_live_option(live); !given.empty()) {
        throw OptionError({.problem = fmt::format("option '{}' is of a live source", given),
                           .actual = "option 'live' is not given",
                           .expected = {},
                           .suggestion = fmt::format("name the source with option 'live', or leave "
                                                     "out option '{}'",
                                                     given)});
    }
}

}  // namespace

std::string TrackCommand::purpose() const {
    return "find and follow the spheres in a video or in images";
}

Command::Inputs TrackCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning =
                "videos, images (PNG, TIFF, JPEG, BMP, PGM), a folder or a quoted pattern of "
                "them: one film in natural order",
            .count = Count::any};
}

std::vector<OptionTable> TrackCommand::options() {
    OptionTable own("");
    own.text("output", output_, "trajectory file to write (H5MD)");
    describe(job_.film, own);
    pipelines::describe(job_.lab, own);
    own.flag("no-link", job_.film.is_part,
             "the frames are a part of the film: no identities, 'grainfield link' joins parts");
    own.text("part-of", job_.film.part_of,
             "with no-link: frames of the whole film, as FIRST:END:STEP; by default all, in the "
             "same steps");
    own.integer("previews", job_.previews, "-", {0, 1000}, "frames kept in the output to look at");
    own.text("camera", job_.camera,
             "camera file of calibrate-camera: positions are corrected for lens and tilt");
    own.text("calibration", job_.calibration,
             "use the calibration that another run kept in this file");
    own.text("save-calibration", job_.save_calibration,
             "keep all that is estimated in this file (TOML), for films to come");
    own.flag("resume", job_.resume.resume, "go on from OUTPUT.checkpoint if it is there");
    own.affects(Effect::call);  // a run that was gone on with is recorded as one
    own.number("checkpoint-every", checkpoint_every_, "min", {0, 1e6}, "time between checkpoints");
    own.affects(Effect::work);
    describe(live_, own);
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : tracking::describe(job_.tracking)) tables.push_back(std::move(table));
    return tables;
}

void TrackCommand::make_room_for(const GivenText& given) {
    pipelines::make_room_for(job_.lab, [&](const std::string& option) {
        const std::string text = given("", option);
        return !text.empty() && text != automatic;
    });
}

std::vector<std::string> TrackCommand::usual() const {
    return {"output", "fps",  "sphere-diameter", "height", "disc-diameter", "frames",
            "region", "mask", "synthesis",       "resume"};
}

std::string TrackCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    return named_after(inputs, "-tracks.h5");
}

Summary TrackCommand::run(Session& session) {
    require_output(session, output_);
    require_hdf5_name(output_);
    job_.output = output_;
    job_.resume.every = std::chrono::duration<double>(60 * checkpoint_every_);
    if (!live_.source.empty()) return run_live(session);
    require_film(session, live_);
    if (session.common.explain) {
        pipelines::plan_tracking(job_, session);
        return explanation(session.plan);
    }
    const TrackJobResult result = pipelines::track_film(job_, session);
    return {.text = words(session, result, result.lab),
            .facts = facts(result, result.lab),
            .signal = result.signal};
}

/// A signal is the usual end of a live run: exit code 0. A source that fell silent is none.
Summary TrackCommand::run_live(Session& session) const {
    if (session.common.explain) {
        pipelines::plan_live(live_, job_, session);
        return explanation(session.plan);
    }
    const pipelines::LiveJobResult result = pipelines::track_live(live_, job_, session);
    Summary summary{.text = words(session, result.track, result.track.lab) + live_in_words(result),
                    .facts = facts(result.track, result.track.lab)};
    summary.facts["live"] = live_facts(result);
    if (result.is_silent) summary.code = ExitCode::bad_input;
    return summary;
}

}  // namespace grainfield::app
