#include "app/info_command.h"

#include <fmt/format.h>

#include "app/bias_summary.h"
#include "core/errors.h"
#include "io/file_kind.h"
#include "io/frame_files.h"
#include "io/frame_scale.h"
#include "io/h5/field_file.h"
#include "io/h5/fingerprint.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/joined_films.h"
#include "io/open_snapshots.h"
#include "io/text/points_csv.h"
#include "pipelines/camera/camera_file.h"
#include "pipelines/lab.h"
#include "pipelines/track/calibration_file.h"
#include "pipelines/track/stored_bias.h"
#include "pipelines/track/stored_binning.h"
#include "report/text.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;

const char* name(Origin origin) {
    switch (origin) {
        case Origin::video:
            return "video";
        case Origin::md:
            return "molecular dynamics";
        case Origin::rendered:
            return "rendered frames";
        case Origin::points:
            return "points";
        case Origin::field:
            return "density fields";
    }
    return "unknown";
}

const char* name(LengthUnit unit) {
    return unit == LengthUnit::pixel ? "px" : "a";
}

const char* name(Boundary boundary) {
    return boundary == Boundary::periodic ? "periodic" : "walls";
}

/// Collects facts in words and as JSON side by side.
class Sheet {
 public:
    explicit Sheet(std::string title) { summary_.text = std::move(title) + "\n"; }

    template <class Value>
    void add(const char* key, const char* label, const Value& value, const std::string& words) {
        summary_.facts[key] = value;
        summary_.text += fmt::format("  {:<12} {}\n", label, words);
    }
    template <class Value>
    void add(const char* key, const char* label, const Value& value) {
        add(key, label, value, fmt::format("{}", value));
    }

    /// `has_diameter`: false for points that state none.
    void add_info(const TrajectoryInfo& info, bool has_diameter = true) {
        add("origin", "origin", std::string(name(info.origin)));
        add("source", "source", info.source);
        if (has_diameter) {
            add("diameter", "diameter", info.diameter,
                fmt::format("{:.5g} {}", info.diameter, name(info.length_unit)));
        } else {
            add("diameter", "diameter", nullptr, "not stated; give analyze --sphere-diameter");
        }
        if (info.frame_rate) {
            add("frame_rate", "frame rate", *info.frame_rate,
                fmt::format("{:.6g} per {}", *info.frame_rate, plain_text(info.time_unit)));
        } else {
            add("frame_rate", "frame rate", nullptr, "unknown");
        }
    }

    void add_lab(const TrajectoryInfo& info, const LabUnits& lab) {
        if (lab.sphere_mm) {
            add("sphere_mm", "sphere", *lab.sphere_mm,
                fmt::format("{:.5g} mm, 1 {} is {:.4g} mm", *lab.sphere_mm, name(info.length_unit),
                            *lab.sphere_mm / info.diameter));
        }
        const std::string moved = pipelines::vibration_in_words(info, lab);
        if (!moved.empty()) add("vibration", "vibration", moved);
    }

    void add_box(const Box& box, const char* unit) {
        add("box", "box", ordered_json{box.length.x, box.length.y},
            fmt::format("{:.6g} x {:.6g} {}, {} in x, {} in y", box.length.x, box.length.y, unit,
                        name(box.boundary[0]), name(box.boundary[1])));
    }

    /// "field, 2D, b = 4, ν = 0.001"
    void add_model(const RunIdentity& identity) {
        ordered_json facts{{"dimension", identity.dimension}};
        if (identity.gradient_order) facts["b"] = *identity.gradient_order;
        if (identity.control) facts["nu"] = identity.control->value;
        add("model", "model", facts, legend_of(identity));
    }

    void add_record(const RunRecord& record) {
        if (record.command.empty()) return add_warnings(record);  // of a run that was cut off
        add("made_by", "made by",
            ordered_json{
                {"command", record.command}, {"version", record.version}, {"seed", record.seed}},
            fmt::format("grainfield {} {}, seed {}", record.command, record.version, record.seed));
        summary_.facts["inputs"] = ordered_json::array();
        for (const RunRecord::Input& input : record.inputs) {
            summary_.facts["inputs"].push_back(
                {{"name", input.name}, {"bytes", input.bytes}, {"checksum", input.checksum}});
            summary_.text += fmt::format("  {:<12} {} ({} bytes, {})\n", "from", input.name,
                                         input.bytes, input.checksum);
        }
        for (const auto& [key, value] : record.configuration) {
            summary_.facts["configuration"][key] = value;
        }
        summary_.facts["recorded_skipped"] = record.skipped;
        for (const std::string& skipped : record.skipped) {
            summary_.text += fmt::format("  {:<12} {}\n", "skipped", skipped);
        }
        add_warnings(record);
    }

    Summary take() { return std::move(summary_); }

 private:
    void add_warnings(const RunRecord& record) {
        summary_.facts["recorded_warnings"] = ordered_json::array();
        for (const Warning& warning : record.warnings) {
            summary_.facts["recorded_warnings"].push_back(warning.text);
            summary_.text += fmt::format("  {:<12} {}\n", "warning", warning.text);
        }
    }

    Summary summary_;
};

Summary describe_snapshots(const std::filesystem::path& path, const char* kind) {
    const auto snapshots = io::open_snapshots(path, std::nullopt, {});
    Sheet sheet(fmt::format("{}: {}", path.string(), kind));
    sheet.add("kind", "kind", std::string(kind));
    sheet.add("frames", "frames", snapshots->count());
    const bool has_diameter =
        io::identify(path) != io::FileKind::points || io::states_diameter(path);
    sheet.add_info(snapshots->info(), has_diameter);
    if (snapshots->count() > 0) {
        const Snapshot first = snapshots->read(0);
        sheet.add(
            "particles_first", "particles", first.size(),
            fmt::format("{} in the {} frame, {}", first.size(),
                        snapshots->count() == 1 ? "only" : "first",
                        first.id.empty() || snapshots->count() == 1 ? "not linked" : "linked"));
        sheet.add_box(first.box,
                      has_diameter ? name(snapshots->info().length_unit) : "in their unit");
    }
    if (const auto* file = dynamic_cast<const io::TrajectoryFile*>(snapshots.get())) {
        sheet.add_lab(file->info(), pipelines::lab_units_in(file->curves()));
        if (const auto side = pipelines::stored_binning(file->curves())) {
            sheet.add("binning", "pixels", *side,
                      *side == 1 ? std::string("fitted one by one")
                                 : fmt::format("fitted by blocks of {0} x {0}", *side));
        }
        if (const auto bias = pipelines::stored_bias(file->curves())) {
            sheet.add("bias", "bias", bias_facts(*bias), "positions " + in_words(*bias));
        }
        sheet.add("previews", "previews", file->previews().size());
        sheet.add_record(file->record());
    }
    return sheet.take();
}

/// What results keep of the units of the lab: not the amplitude.
LabUnits lab_of(const Results& results) {
    LabUnits lab;
    const ObservableResult* lengths = results.find("lengths");
    const Measurement* mm = lengths == nullptr ? nullptr : lengths->find_measurement("sphere_mm");
    if (mm != nullptr) lab.sphere_mm = mm->value;
    if (results.source.time_unit == TimeUnit::second) {
        lab.frequency = results.source.vibration_frequency;
    }
    return lab;
}

Summary describe_results(const std::filesystem::path& path) {
    const Results results = io::read_results(path);
    Sheet sheet(fmt::format("{}: results", path.string()));
    sheet.add("kind", "kind", std::string("results"));
    sheet.add("label", "label", results.label);
    if (const ObservableResult* critical = results.find("critical"); critical != nullptr) {
        // Made of other results: it has no frames, particles or box of its own.
        const Curve* curve = critical->find_curve("critical");
        const bool has_points = curve != nullptr && !curve->columns.empty();
        const std::size_t runs = has_points ? curve->columns.front().values.size() : 0;
        sheet.add("runs", "runs", runs,
                  has_points ? fmt::format("{}, {}", runs, curve->title) : "0");
        const Measurement* value = critical->find_measurement("critical_value");
        const Measurement* power = critical->find_measurement("power");
        if (power != nullptr && power->value) {
            sheet.add("power", "power", *power->value,
                      report::with_error(*power->value, power->error ? &*power->error : nullptr));
        }
        if (value != nullptr && value->value) {
            const std::string why = value->reason.empty() ? "" : " (" + value->reason + ")";
            sheet.add(
                "critical_value", "critical", *value->value,
                report::with_error(*value->value, value->error ? &*value->error : nullptr) + why);
        }
        sheet.add_record(results.record);
        return sheet.take();
    }
    if (results.identity.is_field()) {
        // No particles, no film: lengths are in l.
        sheet.add("origin", "origin", std::string(name(Origin::field)), "field model");
        sheet.add_model(results.identity);
        sheet.add("source", "source", results.source.source);
        if (results.identity.dimension == 1) {
            sheet.add(
                "box", "box", ordered_json{results.box.length.x, results.box.length.y},
                fmt::format("{:.6g} l, {}", results.box.length.x, name(results.box.boundary[0])));
        } else {
            sheet.add_box(results.box, "l");
        }
    } else {
        sheet.add("frames", "frames", results.frames);
        sheet.add("particles_mean", "particles", results.particles_mean,
                  fmt::format("{} per frame", mean_text(results.particles_mean)));
        sheet.add_info(results.source);
        sheet.add_lab(results.source, lab_of(results));
        sheet.add_box(results.box, name(results.source.length_unit));
    }
    ordered_json names = ordered_json::array();
    std::string words;
    for (const ObservableResult& observable : results.observables) {
        names.push_back(observable.name);
        words += (words.empty() ? "" : ", ") + observable.name;
    }
    sheet.add("observables", "observables", names, words);
    sheet.add_record(results.record);
    return sheet.take();
}

Summary describe_fields(const std::filesystem::path& path) {
    io::FieldFile file(path);
    Sheet sheet(fmt::format("{}: density fields", path.string()));
    sheet.add("kind", "kind", std::string("field"));
    sheet.add_model(file.identity());
    sheet.add("frames", "fields", file.count());
    if (file.count() > 0) {
        const FieldFrame first = file.read(0);
        const DensityField& field = first.density.front();
        const bool is_line = file.identity().dimension == 1;
        const std::string sites =
            is_line ? fmt::format("{}", field.nx) : fmt::format("{} x {}", field.nx, field.ny);
        sheet.add("lattice", "lattice", ordered_json{field.nx, field.ny},
                  fmt::format("{} cells of {:g} l, {}, {}", sites, field.spacing,
                              counted(static_cast<std::int64_t>(first.density.size()), "replica"),
                              first.order.value.empty() ? "no order field" : "with order field"));
    }
    std::string words;
    for (const ObservableResult& observable : file.statistics()) {
        words += (words.empty() ? "" : ", ") + observable.name;
    }
    sheet.add("statistics", "statistics", words);
    sheet.add_record(file.record());
    return sheet.take();
}

Summary describe_fingerprint(const std::filesystem::path& path) {
    switch (io::identify(path)) {
        case io::FileKind::trajectory:
        case io::FileKind::results:
        case io::FileKind::field:
            break;
        default:
            throw InputError({.problem = fmt::format("'{}' has no fingerprint", path.string()),
                              .actual = "it is none of these files",
                              .expected = "a trajectory, results or fields (.h5)",
                              .suggestion = "use cmp or sha256sum"});
    }
    const io::Fingerprint fingerprint = io::fingerprint_of(path);
    if (fingerprint.stored && *fingerprint.stored != fingerprint.data) {
        throw InputError({.problem = fmt::format("the data of '{}' are not those that were written",
                                                 path.string()),
                          .actual = fmt::format("fingerprint {}", fingerprint.data),
                          .expected = *fingerprint.stored,
                          .suggestion = "it was damaged or changed; make it again"});
    }
    Summary summary;
    summary.text = fmt::format("{}  {}\n", fingerprint.data, path.string());
    summary.facts["fingerprint"] = fingerprint.data;
    return summary;
}

Summary describe_calibration(const std::filesystem::path& path) {
    const tracking::KeptCalibration kept = pipelines::read_calibration(path);
    const tracking::ImageModel& model = kept.model;
    Sheet sheet(fmt::format("{}: kept calibration", path.string()));
    sheet.add("kind", "kind", std::string("calibration"));
    sheet.add("width", "width", kept.width, fmt::format("{} px", kept.width));
    sheet.add("height", "height", kept.height, fmt::format("{} px", kept.height));
    sheet.add("polarity", "spheres",
              std::string(model.polarity == tracking::Polarity::dark ? "dark" : "bright"));
    const tracking::DiscProfile disc = model.in_pixels().disc;
    sheet.add("diameter_px", "diameter", disc.diameter, fmt::format("{:.3f} px", disc.diameter));
    sheet.add("edge_width_px", "edge width", disc.edge_width,
              fmt::format("{:.3f} px", disc.edge_width));
    const int binning = model.binning.factor;
    sheet.add("binning", "binning", binning,
              binning == 1 ? std::string("none") : fmt::format("{0} x {0} px", binning));
    sheet.add("meeting_edges", "meeting edges", std::string(model.overlap->name()));
    sheet.add("profile", "profile",
              std::string(model.correction.is_zero() ? model.disc.shape->name() : "learned"));
    const double clear = model.in_pixels().background(0.5 * kept.width, 0.5 * kept.height);
    sheet.add("background", "background", clear,
              fmt::format("{:.1f} counts in the middle, {}", clear,
                          model.background.is_uniform() ? "uniform" : "a surface"));
    sheet.add("core", "core", model.dark_level, fmt::format("{:.1f} counts", model.dark_level));
    sheet.add("residual", "residual", kept.check.residual,
              fmt::format("{:.4f} of the contrast", kept.check.residual));
    if (kept.bias) {
        const tracking::BiasDecision bias{.source = tracking::BiasSource::film,
                                          .moved = {},
                                          .before = kept.bias->before,
                                          .after = kept.bias->after,
                                          .reason = {}};
        sheet.add("bias", "bias", bias_facts(bias), "positions " + in_words(bias));
    }
    if (kept.optics) {
        const tracking::MirrorOptics& optics = kept.optics->optics;
        const tracking::OpticsErrors& error = kept.optics->error;
        sheet.add("optics", "optics",
                  ordered_json{{"reflectivity", optics.reflectivity},
                               {"reflectivity_std", error.reflectivity},
                               {"blur_a", optics.blur},
                               {"blur_std_a", error.blur},
                               {"ambient", optics.ambient},
                               {"ambient_std", error.ambient},
                               {"grazing", optics.grazing},
                               {"grazing_std", error.grazing}},
                  in_words(optics, error));
        const tracking::FilmOptics& film = *kept.optics;
        const tracking::ErrorScale& scale = film.error_scale;
        sheet.add(
            "optics_hold_for", "  hold for",
            ordered_json{{"sphere_diameter_px", film.diameter},
                         {"height_a", film.height},
                         {"camera_distance_a", optics.distance}},
            fmt::format("a = {:.6g} px, height {:.6g} a, camera {}", film.diameter, film.height,
                        optics.distance > 0 ? fmt::format("{:.6g} a away", optics.distance)
                                            : "telecentric"));
        sheet.add(
            "error_factors", "  errors times",
            ordered_json{{"plane", scale.plane}, {"height", scale.height}},
            fmt::format("{:.2f} and {:.2f} in the plane, {:.2f} and {:.2f} in height (spheres "
                        "that overlap another in the picture, and others)",
                        scale.plane[0], scale.plane[1], scale.height[0], scale.height[1]));
    }
    if (kept.camera) {
        sheet.add(
            "camera_residual_px", "camera", kept.camera->residual_rms,
            fmt::format("lens and tilt, residual {:.4f} px per axis", kept.camera->residual_rms));
    }
    return sheet.take();
}

Summary describe_camera(const std::filesystem::path& path) {
    const tracking::Camera camera = pipelines::read_camera(path);
    const tracking::Lens& lens = camera.lens;
    Sheet sheet(fmt::format("{}: camera", path.string()));
    sheet.add("kind", "kind", std::string("camera"));
    sheet.add("width", "width", camera.width, fmt::format("{} px", camera.width));
    sheet.add("height", "height", camera.height, fmt::format("{} px", camera.height));
    sheet.add("focal_px", "focal length", lens.focal, fmt::format("{:.5g} px", lens.focal));
    sheet.add("centre_px", "centre", ordered_json{lens.centre.x, lens.centre.y},
              fmt::format("({:.1f}, {:.1f}) px", lens.centre.x, lens.centre.y));
    sheet.add("distortion", "k1 k2 p1 p2", ordered_json{lens.k1, lens.k2, lens.p1, lens.p2},
              fmt::format("{:.4g}, {:.4g}, {:.4g}, {:.4g}", lens.k1, lens.k2, lens.p1, lens.p2));
    if (camera.scale) {
        const char* unit = camera.scale->unit == tracking::PlaneUnit::mm ? "mm" : "a";
        sheet.add(
            "scale", "scale", camera.scale->length,
            fmt::format("1 px is {:.5g} {} in the plane of the cell", camera.scale->length, unit));
        sheet.add("scale_unit", "unit", std::string(unit));
    } else {
        sheet.add("scale", "scale", nullptr, "not known");
    }
    sheet.add("residual_px", "residual", camera.residual_rms,
              fmt::format("{:.4f} px per axis", camera.residual_rms));
    return sheet.take();
}

Summary describe_frames(Session& session) {
    session.inputs = io::recording_files(session.inputs);
    const auto frames = io::open_frames(session.inputs, {});
    Sheet sheet(fmt::format("{}: camera frames", frames->name()));
    sheet.add("kind", "kind", std::string("frames"));
    sheet.add("files", "files", session.inputs.size());
    sheet.add("frames", "frames", frames->count());
    sheet.add("width", "width", frames->width(), fmt::format("{} px", frames->width()));
    sheet.add("height", "height", frames->height(), fmt::format("{} px", frames->height()));
    sheet.add("bit_depth", "bit depth", frames->bit_depth());
    if (const auto* scale = dynamic_cast<const io::FrameScale*>(frames.get());
        scale != nullptr && scale->pixel_mm()) {
        sheet.add("pixel_mm", "pixel", *scale->pixel_mm(),
                  fmt::format("{:.6g} mm", *scale->pixel_mm()));
    }
    if (frames->frame_rate()) {
        sheet.add("frame_rate", "frame rate", *frames->frame_rate(),
                  fmt::format("{:.6g} per s", *frames->frame_rate()));
    } else {
        sheet.add("frame_rate", "frame rate", nullptr, "unknown; give --fps");
    }
    for (const std::string& warning : frames->warnings()) session.plan.warn(warning);
    return sheet.take();
}

}  // namespace

std::string InfoCommand::purpose() const {
    return "say what a file holds";
}

Command::Inputs InfoCommand::inputs() const {
    return {.placeholder = "FILE",
            .meaning = "a trajectory, results, points, video or image file",
            .count = Count::one};
}

std::vector<OptionTable> InfoCommand::options() {
    OptionTable table("");
    table.flag("fingerprint", fingerprint_,
               "print the digest of the data, the same for any threads and times");
    return {table};
}

Summary InfoCommand::run(Session& session) {
    const std::filesystem::path& path = session.inputs.front();
    if (fingerprint_) return describe_fingerprint(path);
    std::error_code absent;
    const bool is_file = std::filesystem::is_regular_file(path, absent);
    if (!is_file) return describe_frames(session);
    switch (io::identify(path)) {
        case io::FileKind::trajectory:
            return describe_snapshots(path, "trajectory");
        case io::FileKind::points:
            return describe_snapshots(path, "points");
        case io::FileKind::results:
            return describe_results(path);
        case io::FileKind::field:
            return describe_fields(path);
        case io::FileKind::unknown:
            break;
    }
    if (path.extension() == ".toml") {
        return pipelines::is_camera_file(path) ? describe_camera(path) : describe_calibration(path);
    }
    return describe_frames(session);
}

}  // namespace grainfield::app
