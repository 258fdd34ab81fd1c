#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/version.h"
#include "io/h5/detail/curve_group.h"
#include "io/h5/detail/data_digest.h"
#include "io/h5/detail/flat_columns.h"
#include "io/h5/detail/h5_group.h"
#include "io/h5/detail/preview_group.h"
#include "io/h5/detail/run_record_json.h"
#include "io/h5/detail/trajectory_columns.h"
#include "io/h5/trajectory_file.h"

namespace grainfield::io {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t no_id = -1;
constexpr auto no_layer = static_cast<std::int8_t>(Layer::unknown);
constexpr hsize_t scalars_per_chunk = 1024;

// Room for a few more particles than the first frame has, so that frames seldom need two chunks.
hsize_t particles_per_chunk(std::size_t first) {
    return std::clamp<hsize_t>(first + first / 16, 256, 65536);
}

std::string boundary_name(Boundary boundary) {
    return boundary == Boundary::periodic ? "periodic" : "none";
}

std::vector<double> heights(const Snapshot& snapshot) {
    if (!snapshot.z.empty()) return snapshot.z;
    std::vector<double> heights(snapshot.size(), 0);
    for (std::size_t i = 0; i < snapshot.layer.size(); ++i) {
        heights[i] = snapshot.layer[i] == Layer::top ? 1 : 0;
    }
    return heights;
}

std::vector<double> positions(const Snapshot& snapshot) {
    const std::vector<double> z = heights(snapshot);
    std::vector<double> numbers;
    numbers.reserve(3 * snapshot.size());
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        numbers.insert(numbers.end(), {snapshot.position[i].x, snapshot.position[i].y, z[i]});
    }
    return numbers;
}

/// The record, as long whatever the wall time was: files of equal runs then differ in its digits
/// (and their checksum) only.
std::string record_text(const RunRecord& record) {
    RunRecord timeless = record;
    timeless.seconds = 0;
    constexpr std::size_t most_digits = 24;
    const std::size_t length = text_of(to_json(timeless)).size() + most_digits;
    std::string text = text_of(to_json(record));
    text.resize(std::max(text.size(), length), ' ');
    return text;
}

void describe_h5md(const H5Group& root) {
    const H5Group h5md = root.make_group("h5md");
    h5md.set_attribute("version", std::array<std::int64_t, 2>{1, 1});
    h5md.make_group("author").set_attribute("name", std::string("grainfield"));
    const H5Group creator = h5md.make_group("creator");
    creator.set_attribute("name", std::string("grainfield"));
    creator.set_attribute("version", std::string(kVersion));
}

}  // namespace

struct TrajectoryWriter::State {
    State(OutputFile claimed, const TrajectoryInfo& info);

    void write(const Snapshot& snapshot);
    void require_in_order(const Snapshot& snapshot) const;
    void make_positions(const Snapshot& first);
    void write_box(const Box& snapshot_box);

    /// Makes the element when the column is first met; frames before it hold the fill value.
    template <class T>
    void write_column(TrajectoryColumn column, hsize_t width, T fill, const std::vector<T>& values);

    template <class T>
    void append(const H5Dataset& data, std::span<const T> values) {
        data.extend(frames + 1, 0);
        data.write_row<T>(frames, values.size(), values);
    }

    OutputFile output;
    H5File file;
    double unknown_height;
    H5Group own, previews, particles, box, position;
    H5Dataset step, time, edges, positions_value, columns, box_origin, box_height;
    std::array<H5Dataset, trajectory_column_names.size()> column_value;
    std::optional<std::array<Boundary, 2>> boundary;
    hsize_t chunk = 0;
    hsize_t frames = 0;
    hsize_t most_particles = 0;
    std::int64_t last_frame = -1;
    std::uint8_t present = 0;  ///< columns of the frame being written
    int preview_count = 0;
    std::vector<Curve> curves;
};

TrajectoryWriter::State::State(OutputFile claimed, const TrajectoryInfo& info)
    : output(std::move(claimed)),
      file(H5File::create(output.temporary(), output.target().string())),
      unknown_height(info.diameter) {
    const H5Group root = H5Group::root(file);
    describe_h5md(root);
    own = root.make_group("parameters").make_group("grainfield");
    own.set_attribute("version", trajectory_version);
    own.write_text("info", text_of(to_json(info)));
    previews = own.make_group("previews");
    columns = own.make_series<std::uint8_t>("columns", {}, {scalars_per_chunk}, 0);
    box_origin = own.make_series<double>("box_origin", {2}, {scalars_per_chunk, 2}, nan);
    box_height = own.make_series<double>("box_height", {}, {scalars_per_chunk}, nan);

    particles = root.make_group("particles").make_group("trajectory");
    position = particles.make_group("position");
    step = position.make_series<std::int64_t>("step", {}, {scalars_per_chunk}, -1);
    time = position.make_series<double>("time", {}, {scalars_per_chunk}, nan);
    box = particles.make_group("box");
    box.set_attribute("dimension", std::int64_t{3});
    const H5Group element = box.make_group("edges");
    edges = element.make_series<double>("value", {3, 3}, {scalars_per_chunk / 8, 3, 3}, nan);
    element.link("step", position, "step");
    element.link("time", position, "time");
    file.flush();
}

void TrajectoryWriter::State::require_in_order(const Snapshot& snapshot) const {
    if (snapshot.frame <= last_frame) {
        file.fail(fmt::format("frame {} after frame {}", snapshot.frame, last_frame),
                  "frames in growing order from 0");
    }
    if (boundary && *boundary != snapshot.box.boundary) {
        file.fail(fmt::format("frame {} has other boundaries than those before", snapshot.frame));
    }
}

void TrajectoryWriter::State::make_positions(const Snapshot& first) {
    chunk = particles_per_chunk(first.size());
    boundary = first.box.boundary;
    const std::array names{boundary_name(first.box.boundary[0]),
                           boundary_name(first.box.boundary[1]), boundary_name(Boundary::walls)};
    box.set_attribute("boundary", names);
    positions_value = position.make_series<double>("value", {0, 3}, {1, chunk, 3}, nan);
}

void TrajectoryWriter::State::write_box(const Box& snapshot_box) {
    const Vec2 length = snapshot_box.length;
    const double height = snapshot_box.height > 0 ? snapshot_box.height : unknown_height;
    const std::array<double, 9> matrix{length.x, 0, 0, 0, length.y, 0, 0, 0, height};
    edges.extend(frames + 1, 3);
    edges.write_row<double>(frames, 3, matrix);
    const std::array<double, 2> corner{snapshot_box.origin.x, snapshot_box.origin.y};
    append<double>(box_origin, corner);
    append<double>(box_height, std::array{snapshot_box.height});
}

template <class T>
void TrajectoryWriter::State::write_column(TrajectoryColumn column, hsize_t width, T fill,
                                           const std::vector<T>& values) {
    if (values.empty()) return;
    present |= bit_of(column);
    H5Dataset& data = column_value[index_of(column)];
    if (!data) {
        const H5Group element = particles.make_group(trajectory_column_names[index_of(column)]);
        H5Extent row{0};
        H5Extent chunks{1, chunk};
        if (width > 1) {
            row.push_back(width);
            chunks.push_back(width);
        }
        data = element.make_series<T>("value", row, chunks, fill);
        element.link("step", position, "step");
        element.link("time", position, "time");
    }
    data.extend(frames + 1, most_particles);
    data.write_row<T>(frames, values.size() / width, values);
}

void TrajectoryWriter::State::write(const Snapshot& snapshot) {
    require_consistent(snapshot);
    require_in_order(snapshot);
    if (!positions_value) make_positions(snapshot);
    most_particles = std::max<hsize_t>(most_particles, snapshot.size());
    present = snapshot.z.empty() ? std::uint8_t{0} : bit_of(TrajectoryColumn::z);

    positions_value.extend(frames + 1, most_particles);
    positions_value.write_row<double>(frames, snapshot.size(), positions(snapshot));
    write_column(TrajectoryColumn::id, 1, no_id, snapshot.id);
    write_column(TrajectoryColumn::velocity, 3, nan, flat(snapshot.velocity));
    write_column(TrajectoryColumn::spin, 3, nan, flat(snapshot.spin));
    write_column(TrajectoryColumn::position_error, 2, nan, flat(snapshot.position_error));
    write_column(TrajectoryColumn::z_error, 1, nan, snapshot.z_error);
    write_column(TrajectoryColumn::quality, 1, nan, snapshot.quality);
    write_column(TrajectoryColumn::layer, 1, no_layer, flat(snapshot.layer));
    for (const H5Dataset& data : column_value) {
        if (data) data.extend(frames + 1, most_particles);
    }
    write_box(snapshot.box);
    append<std::uint8_t>(columns, std::array{present});
    append<double>(time, std::array{snapshot.time});
    append<std::int64_t>(step, std::array{snapshot.frame});
    last_frame = snapshot.frame;
    ++frames;
    file.flush();
}

TrajectoryWriter::TrajectoryWriter(const std::filesystem::path& path, const TrajectoryInfo& info,
                                   Overwrite overwrite)
    : TrajectoryWriter(OutputFile(path, overwrite), info) {}

TrajectoryWriter::TrajectoryWriter(OutputFile output, const TrajectoryInfo& info)
    : state_(std::make_unique<State>(std::move(output), info)) {}

TrajectoryWriter::~TrajectoryWriter() = default;
TrajectoryWriter::TrajectoryWriter(TrajectoryWriter&&) noexcept = default;

void TrajectoryWriter::write(const Snapshot& snapshot) {
    state_->write(snapshot);
}

void TrajectoryWriter::add_preview(const Preview& preview) {
    write_preview(state_->previews, std::to_string(state_->preview_count++), preview);
}

void TrajectoryWriter::add_curve(const Curve& curve) {
    state_->curves.push_back(curve);
}

void TrajectoryWriter::finish(const RunRecord& record) {
    // A file without frames still is a trajectory: of no frame, with no particles.
    if (!state_->positions_value) state_->make_positions({});
    state_->own.write_text("record", record_text(record));
    if (!state_->curves.empty()) {
        write_curves(state_->own.make_group("curves"), state_->curves);
    }
    store_digest(state_->file);
    state_->file.close();
    state_->output.commit();
}

}  // namespace grainfield::io
