// make-seeds FOLDER: the seeds of the fuzzers in formats that are grainfield's own, one folder a
// reader.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "analysis/analysis.h"
#include "app/command.h"
#include "app/config_file.h"
#include "core/support/snapshot_numbers.h"
#include "io/frame_files.h"
#include "io/h5/checkpoint_file.h"
#include "io/h5/detail/run_record_json.h"
#include "io/h5/field_file.h"
#include "io/h5/record_log.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/text/export_files.h"
#include "pipelines/camera/camera_file.h"
#include "pipelines/track/calibration_file.h"
#include "simulate/field/integrators/adjoint.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"
#include "tests/fuzz/checkpoint_jobs.h"
#include "tests/io/file_samples.h"
#include "tracking/calibrate/illumination.h"
#include "tracking/layers/bilayer.h"
#include "tracking/model/known_models.h"
#include "tracking/synthesis/film_synthesis.h"
#include "tracking/tracker_state.h"

namespace grainfield::fuzz {
namespace {

namespace fs = std::filesystem;

fs::path in(const fs::path& folder, const std::string& reader, const std::string& name) {
    fs::create_directories(folder / reader);
    return folder / reader / name;
}

class MemorySource : public SnapshotSource {
 public:
    TrajectoryInfo description;
    std::vector<Snapshot> snapshots;

    const TrajectoryInfo& info() const override { return description; }
    std::int64_t count() const override { return static_cast<std::int64_t>(snapshots.size()); }
    Snapshot read(std::int64_t index) override {
        return snapshots.at(static_cast<std::size_t>(index));
    }
};

MemorySource sample(std::size_t particles) {
    MemorySource source;
    source.description = sample_info();
    for (int i = 0; i < 3; ++i) {
        Snapshot snapshot = full_snapshot(i, particles);
        snapshot.box = full_snapshot(0, 1).box;
        source.snapshots.push_back(std::move(snapshot));
    }
    return source;
}

Frame picture(int bit_depth, std::int64_t index) {
    Frame frame;
    frame.index = index;
    frame.time = static_cast<double>(index) / 25;
    frame.bit_depth = bit_depth;
    frame.image = Image(20, 14);
    for (std::size_t i = 0; i < frame.image.size(); ++i) {
        frame.image.pixels()[i] =
            static_cast<float>((i * 37 + static_cast<std::size_t>(index)) % (1U << bit_depth));
    }
    return frame;
}

void write_frames(const fs::path& folder) {
    const fs::path scratch = folder / "scratch";
    for (const int bit_depth : {8, 16}) {
        for (const char* name : {"TIFF", "PNG"}) {
            const io::ImageFormat* format = io::find_image_format_named(name);
            fs::remove_all(scratch);
            const auto writer = io::make_frame_writer(
                scratch,
                {.format = format, .width = 20, .height = 14, .bit_depth = bit_depth, .fps = 25},
                Overwrite::force);
            writer->write(picture(bit_depth, 0));
            writer->finish();
            const fs::path file = fs::directory_iterator(scratch)->path();
            fs::copy_file(
                file,
                in(folder, "images",
                   "own-" + std::to_string(bit_depth) + "." + std::string(format->extension)),
                fs::copy_options::overwrite_existing);
        }
        const auto video = io::make_frame_writer(
            in(folder, "videos", "own-" + std::to_string(bit_depth) + ".avi"),
            {.width = 20, .height = 14, .bit_depth = bit_depth, .fps = 25}, Overwrite::force);
        for (int i = 0; i < 3; ++i) video->write(picture(bit_depth, i));
        video->finish();
    }
    fs::remove_all(scratch);
}

void write_h5(const fs::path& folder) {
    MemorySource source = sample(5);
    io::TrajectoryWriter trajectory(in(folder, "trajectories", "own.h5"), source.info(),
                                    Overwrite::force);
    for (const Snapshot& snapshot : source.snapshots) trajectory.write(snapshot);
    trajectory.add_preview(sample_preview());
    trajectory.finish(sample_record());
    io::TrajectoryWriter plain(in(folder, "trajectories", "plain.h5"), {}, Overwrite::force);
    plain.write(plain_snapshot(0, 3));
    plain.finish({});

    Results results;
    results.source = source.info();
    results.record = sample_record();
    results.box = source.snapshots[0].box;
    results.frames = 3;
    results.particles_mean = 5;
    ObservableResult sk;
    sk.name = "sk";
    sk.measurements = {{"s_lowest_k", "-", 1.25, 0.1, 16, ""}};
    sk.curves = {{"sk", "S(k)", {{"k", "1/a", "k", {1, 2}}, {"s", "-", "S", {0.5, 0.25}}}, {}}};
    sk.options = {{"k-max", OptionValue(3.0)}};
    results.observables = {sk};
    io::write_results(in(folder, "results", "own.h5"), results, Overwrite::force);

    FieldFrame frame;
    frame.dimension = 2;
    frame.mean_diffusivity = 0.5;
    frame.density = {{.step = 0, .time = 0, .nx = 3, .ny = 2, .spacing = 0.65, .value = {}}};
    frame.density[0].value = {1, 2, 3, 4, 5, 6};
    frame.order = frame.density[0];
    io::FieldWriter fields(in(folder, "fields", "own.h5"), Overwrite::force);
    fields.write(frame);
    fields.finish({sk}, {.origin = Origin::field, .control = std::nullopt}, sample_record());

    std::ofstream(in(folder, "records", "record.json"))
        << io::text_of(io::to_json(sample_record()));
    std::ofstream(in(folder, "records", "info.json")) << io::text_of(io::to_json(sample_info()));
    std::ofstream(in(folder, "records", "box.json")) << io::text_of(io::to_json(results.box));
    std::ofstream(in(folder, "records", "identity.json"))
        << io::text_of(io::to_json(identity_of(sample_info())));
}

/// The first line, which says whose options they are (fuzz_configurations.cpp).
std::string chosen(std::size_t command) {
    return "# " + std::string(1, static_cast<char>('A' + command)) + "\n";
}

/// Options that stand as comments, since they are at their defaults, become options.
std::string without_comments(const std::string& text) {
    std::istringstream lines(text);
    std::string options;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("# ") && line.find(" = ") != std::string::npos) line.erase(0, 2);
        line.erase(std::min(line.find("  # "), line.size()));
        if (!line.empty() && !line.starts_with("#")) options += line + "\n";
    }
    return options;
}

void write_texts(const fs::path& folder) {
    MemorySource source = sample(4);
    io::export_csv(source, in(folder, "points", "own.csv"), Overwrite::force, {.header = true});
    std::ofstream(in(folder, "points", "other.csv"))
        << "Frame, X,y ,mass\r\n0,1.5,2,7\r\n0,3,4.25,7\r\n\r\n# a comment\r\n2,1e0,19,7\r\n";
    std::ofstream(in(folder, "wavevectors", "named.csv")) << "kx,ky\n0.5,1\n# more\n-2,1e-1\n";
    std::ofstream(in(folder, "wavevectors", "plain.csv")) << "1,2\n\n3,4\n";

    const std::vector<std::pair<std::size_t, std::string>> samples{
        {5, "md-small"}, {6, "field-small"}, {7, "camera"}, {11, "scene"}};
    for (const auto& [command, name] : samples) {
        std::ofstream(in(folder, "configurations", name + ".toml"))
            << chosen(command)
            << read_bytes(fs::path(GRAINFIELD_SOURCE_DIR) / "data-samples" / (name + ".toml"));
    }
    const auto commands = app::make_commands();
    for (std::size_t i = 0; i < commands.size(); ++i) {
        std::string name = commands[i]->name();
        std::ranges::replace(name, ' ', '-');
        std::ofstream(in(folder, "configurations", "all-" + name + ".toml"))
            << chosen(i) << without_comments(app::config_text(commands[i]->options(), ""));
    }

    tracking::KeptCalibration kept;
    kept.width = 20;
    kept.height = 14;
    kept.model.disc.diameter = 9;
    kept.model.disc.edge_width = 1.25;
    kept.model.disc.shape = tracking::profile_shapes().front();
    kept.model.overlap = tracking::overlap_rules().front();
    kept.model.correction = {.spacing = 0.5, .value = {0.125F, -0.25F}};
    kept.model.background = tracking::BackgroundSurface(20, 14, 1, {100, 1, -2});
    std::ofstream(in(folder, "calibrations", "own.toml")) << pipelines::text_of(kept);
    tracking::Camera camera;
    camera.width = 20;
    camera.height = 14;
    camera.lens = {.focal = 30, .centre = {9, 7}, .k1 = -0.125, .k2 = 0.25, .p1 = -0.0, .p2 = 0};
    camera.scale = tracking::PlaneScale{0.5, tracking::PlaneUnit::mm};
    camera.cell.emplace();
    camera.cell->length = {10, 8};
    std::ofstream(in(folder, "cameras", "own.toml")) << pipelines::camera_file_text(camera);
    kept.camera = camera;
    std::ofstream(in(folder, "calibrations", "with-camera.toml")) << pipelines::text_of(kept);
}

void write_checkpoint(const fs::path& path, const Checkpoint& checkpoint) {
    io::write_checkpoint(checkpoint, path);
    fs::resize_file(path, fs::file_size(path) - 4);  // the checksum: readers.h
}

class NoSink : public SnapshotSink {
 public:
    void write(const Snapshot& /*snapshot*/) override {}
};

void write_checkpoints(const fs::path& folder) {
    RunPlan plan;
    simulate::MdSimulation md(md_options(), simulate::make_initial_state(md_options(), 1), 1, plan);
    NoSink sink;
    md.run_window(sink);
    write_checkpoint(in(folder, "checkpoints", "md"), md.checkpoint());

    const auto fields = simulate::make_integrator(field_setup(), 1);
    fields->advance(3);
    Checkpoint field;
    field.kind = "field";
    fields->save(field);
    write_checkpoint(in(folder, "checkpoints", "field"), field);

    simulate::AdjointEstimator adjoint(field_setup(), {{1, 0}, {0, 2}}, 1);
    adjoint.advance(3);
    Checkpoint waves;
    adjoint.save(waves);
    waves.kind = "field adjoint";
    write_checkpoint(in(folder, "checkpoints", "adjoint"), waves);

    MemorySource source = sample(12);
    source.description.diameter = 10;
    write_checkpoint(in(folder, "checkpoints", "part"),
                     analysis::measure_part(source, {}, part_options(), {.threads = 1}));
}

template <class State>
void write_state(const fs::path& folder, char kind, State state) {
    NumberArchive archive;
    archive(state);
    const std::vector<double> numbers = archive.take_numbers();
    std::string bytes(1, kind);
    bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
    write_bytes(in(folder, "states", "kind-" + std::to_string(kind)), bytes);
}

void write_states(const fs::path& folder) {
    write_state(folder, 0, full_snapshot(2, 3));
    tracking::LinkState links;
    links.tracks = {{1, 2, {3, 4}, {5, 6}, Vec2{7, 8}}, {9, 10, {11, 12}, {13, 14}, {}}};
    links.frame = 16;
    write_state(folder, 1, links);
    tracking::Located located;
    located.position = {{1, 2}};
    located.error = {{3, 4}};
    located.residual = {5};
    write_state(folder, 2, located);
    write_state(folder, 3, tracking::TrackSummary{});
    tracking::SynthesisedFrame synthesised;
    synthesised.position = {{1, 2}};
    synthesised.z = {0.5};
    write_state(folder, 4, synthesised);
    write_state(folder, 5, tracking::Illumination{});
    write_state(folder, 6, tracking::Bilayer::Summary{});

    const fs::path log = in(folder, "logs", "own");
    fs::remove(log);
    io::RecordLog records(log, 0);
    records.append({1, 2, 3});
    records.append({});
    records.append({4});
}

}  // namespace
}  // namespace grainfield::fuzz

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: make-seeds FOLDER\n";
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    using namespace grainfield::fuzz;
    write_frames(folder);
    write_h5(folder);
    write_texts(folder);
    write_checkpoints(folder);
    write_states(folder);
    return 0;
}
