#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/snapshot_check.h"
#include "io/h5/detail/curve_group.h"
#include "io/h5/detail/flat_columns.h"
#include "io/h5/detail/h5_group.h"
#include "io/h5/detail/legacy_identity.h"
#include "io/h5/detail/preview_group.h"
#include "io/h5/detail/run_record_json.h"
#include "io/h5/detail/trajectory_columns.h"
#include "io/h5/trajectory_file.h"

namespace grainfield::io {

namespace {

constexpr std::array all_columns{TrajectoryColumn::id,
                                 TrajectoryColumn::z,
                                 TrajectoryColumn::velocity,
                                 TrajectoryColumn::spin,
                                 TrajectoryColumn::position_error,
                                 TrajectoryColumn::quality,
                                 TrajectoryColumn::layer,
                                 TrajectoryColumn::z_error};

// Ours is called "trajectory"; elsewhere, the first group that has positions.
H5Group particle_group(const H5File& file, const H5Group& root) {
    if (!root.has("h5md") || !root.has("particles")) {
        file.fail("this HDF5 file holds no trajectory", "H5MD with a group 'particles'");
    }
    const H5Group particles = root.group("particles");
    if (particles.has("trajectory")) return particles.group("trajectory");
    for (const std::string& name : particles.names()) {
        H5Group group = particles.group(name);
        if (group.has("position")) return group;
    }
    file.fail("no group under /particles has positions");
}

// `step` and `time` of H5MD: one number per frame, or one step for all (with an offset).
template <class T>
std::vector<T> sequence(const H5Group& element, const std::string& name, std::size_t count) {
    const H5Dataset data = element.dataset(name);
    std::vector<T> values = data.read<T>();
    if (!data.extent().empty()) {
        if (values.size() < count) {
            element.file().fail(fmt::format("{} has {} entries", data.path(), values.size()),
                                fmt::format("{}, one per frame", count));
        }
        values.resize(count);
        return values;
    }
    const T increment = values.at(0);
    const double offset = data.has_attribute("offset") ? data.number_attribute("offset") : 0;
    if constexpr (std::is_integral_v<T>) {
        constexpr double most = 9007199254740992;  // 2^53
        const double way = std::abs(static_cast<double>(increment)) * static_cast<double>(count);
        if (!(std::abs(offset) + way <= most) || offset != std::trunc(offset)) {
            element.file().fail(
                fmt::format("{} grows from {} by {} a frame", data.path(), offset, increment),
                "whole numbers below 2^53");
        }
    }
    values.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = static_cast<T>(offset) + static_cast<T>(i) * increment;
    }
    return values;
}

template <class T>
void keep_rows(std::vector<T>& column, const std::vector<bool>& keep) {
    if (column.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < column.size(); ++i) {
        if (keep[i]) column[kept++] = column[i];
    }
    column.resize(kept);
}

Boundary boundary_of(const H5File& file, const std::string& name) {
    if (name == "periodic") return Boundary::periodic;
    if (name == "none") return Boundary::walls;
    file.fail(fmt::format("the box has the unknown boundary '{}'", name), "periodic or none");
}

}  // namespace

struct TrajectoryFile::State {
    explicit State(const std::filesystem::path& path);

    void open_positions(const H5Group& root, const H5Group& particles);
    void leave_out_unwritten(const H5Group& own, const H5Group& particles);
    void leave_out_broken();
    void warn_of_its_end();
    void open_box(const H5Group& particles);
    void read_own(const H5Group& root);
    void open_columns(const H5Group& particles);
    void require_frames(const H5Dataset& data) const;
    Box box(hsize_t frame) const;
    Snapshot read(hsize_t frame);
    void require_growing_times() const;
    std::vector<bool> particles_of(const Snapshot& snapshot) const;
    [[noreturn]] void fail(const Snapshot& snapshot, const std::string& actual,
                           std::size_t particle, const std::string& expected) const;
    bool has(TrajectoryColumn column, hsize_t frame) const;
    template <class T>
    std::vector<T> row(TrajectoryColumn column, hsize_t frame, hsize_t width) const;

    H5File file;
    TrajectoryInfo info;
    RunRecord record;
    std::vector<Preview> previews;
    std::vector<Curve> curves;
    bool is_complete = true;    ///< else its writer failed or was killed
    std::int64_t left_out = 0;  ///< frames
    hsize_t frames = 0;
    hsize_t longest = 0;  ///< frames of the longest column
    hsize_t most_particles = 0;
    hsize_t dimensions = 3;
    std::vector<std::int64_t> step;
    std::vector<double> time;
    std::string time_path;
    SnapshotCheck check;
    H5Dataset positions;
    std::array<H5Dataset, trajectory_column_names.size()> columns;
    std::vector<std::uint8_t> present;  ///< per frame, empty for files from elsewhere
    std::array<Boundary, 2> boundary{Boundary::walls, Boundary::walls};
    H5Dataset edges;
    std::vector<double> fixed_edges;  ///< where the box does not depend on time
    std::vector<double> box_origin;   ///< 2 per frame, empty for files from elsewhere
    std::vector<double> box_height;
};

TrajectoryFile::State::State(const std::filesystem::path& path) : file(H5File::open(path)) {
    const H5Group root = H5Group::root(file);
    const H5Group particles = particle_group(file, root);
    open_positions(root, particles);
    open_box(particles);
    read_own(root);
    open_columns(particles);
    if (!is_complete) {
        leave_out_broken();
        warn_of_its_end();
    }
    require_growing_times();
    if (info.source.empty()) info.source = path.filename().string();
}

// The frame at which its writer failed: of some columns it has numbers, of others none.
void TrajectoryFile::State::leave_out_unwritten(const H5Group& own, const H5Group& particles) {
    const auto bound = [&](const H5Dataset& data) {
        const H5Extent extent = data.extent();
        longest = std::max(longest, extent.empty() ? 0 : extent[0]);
        frames = extent.empty() ? 0 : std::min(frames, extent[0]);
    };
    longest = frames;
    const H5Group element = particles.group("position");
    for (const char* name : {"step", "time"}) bound(element.dataset(name));
    for (const char* name : {"columns", "box_origin", "box_height"}) bound(own.dataset(name));
    bound(particles.group("box").group("edges").dataset("value"));
    for (const TrajectoryColumn column : all_columns) {
        const std::string name = trajectory_column_names[index_of(column)];
        if (column != TrajectoryColumn::z && particles.has(name)) {
            bound(particles.group(name).dataset("value"));
        }
    }
    const auto steps = element.dataset("step").read<std::int64_t>();
    const auto times = element.dataset("time").read<double>();
    while (frames > 0) {
        const auto last = static_cast<std::size_t>(frames - 1);
        const bool grows = last == 0 || steps[last] > steps[last - 1];
        if (steps[last] >= 0 && grows && std::isfinite(times[last])) return;
        --frames;
    }
}

// Frames are flushed one by one: more broken ones than these are damage, which reading says.
void TrajectoryFile::State::leave_out_broken() {
    constexpr hsize_t most = 2;
    const hsize_t least = frames - std::min(frames, most);
    const hsize_t all = frames;
    for (; frames > least; --frames) {
        try {
            read(frames - 1);
            break;
        } catch (const InputError&) {
            continue;
        }
    }
    if (frames == least && least > 0) frames = all;
    step.resize(static_cast<std::size_t>(frames));
    time.resize(static_cast<std::size_t>(frames));
    check = {};
}

// It stands in the record, where all who read the file look for what to know about it.
void TrajectoryFile::State::warn_of_its_end() {
    left_out = static_cast<std::int64_t>(longest - frames);
    if (left_out == 0) return;
    record.warnings.push_back(
        {WarningCode::incomplete,
         fmt::format("'{}' was cut off while it was written: {} of its {} frames are left out, as "
                     "columns of them are absent or damaged",
                     file.name(), left_out, longest)});
}

void TrajectoryFile::State::open_positions(const H5Group& root, const H5Group& particles) {
    const H5Group element = particles.group("position");
    positions = element.dataset("value");
    const H5Extent extent = positions.extent();
    if (extent.size() != 3 || (extent[2] != 2 && extent[2] != 3)) {
        file.fail(fmt::format("{} has the extent {}", positions.path(), positions.extent_text()),
                  "[frames, particles, 2 or 3]");
    }
    frames = extent[0];
    most_particles = extent[1];
    dimensions = extent[2];
    if (root.has("parameters") && root.group("parameters").has("grainfield")) {
        const H5Group own = root.group("parameters").group("grainfield");
        is_complete = own.has("record");
        if (!is_complete) leave_out_unwritten(own, particles);
    }
    file.require_plausible(static_cast<double>(frames) * sizeof(double), positions.path());
    const auto count = static_cast<std::size_t>(frames);
    step = sequence<std::int64_t>(element, "step", count);
    if (element.has("time")) {
        time = sequence<double>(element, "time", count);
    } else {
        time.assign(step.begin(), step.end());
    }
    if (std::ranges::adjacent_find(step, std::greater_equal<>()) != step.end() ||
        (!step.empty() && step.front() < 0)) {
        file.fail("the steps do not grow from frame to frame");
    }
    const auto lost = std::ranges::find_if(time, [](double t) { return !std::isfinite(t); });
    if (lost != time.end()) {
        file.fail(
            fmt::format("frame {} has no time in {}/time", lost - time.begin(), element.path()));
    }
    time_path = element.path() + "/time";
}

// The stamps of a film are those of its camera, which the tracker has warned of.
void TrajectoryFile::State::require_growing_times() const {
    if (info.origin == Origin::video) return;
    if (const auto frame = first_not_growing(time)) {
        file.fail(fmt::format("{}: frame {} is at {:.17g}, the one before it at {:.17g}", time_path,
                              *frame, time[*frame], time[*frame - 1]),
                  "times that grow from frame to frame");
    }
}

// Rows that hold a particle. Files have as many rows a frame as the fullest needs: the others have
// identity −1 or, without identities, stand at the end, not a number.
std::vector<bool> TrajectoryFile::State::particles_of(const Snapshot& snapshot) const {
    std::vector<bool> keep(snapshot.size());
    bool is_over = false;
    for (std::size_t p = 0; p < keep.size(); ++p) {
        const bool is_nan =
            std::isnan(snapshot.position[p].x) && std::isnan(snapshot.position[p].y);
        const bool is_named = snapshot.id.empty() || snapshot.id[p] >= 0;
        keep[p] = snapshot.id.empty() ? !is_nan : is_named;
        const bool is_lost = snapshot.id.empty() ? !is_nan && is_over : is_named && is_nan;
        const bool is_nameless = !present.empty() && !is_named && !is_nan;
        is_over = is_over || is_nan;
        if (is_lost) {
            fail(
                snapshot,
                snapshot.id.empty() ? "a particle before it has no position" : "it has no position",
                p, "finite coordinates");
        }
        if (is_nameless) fail(snapshot, "it has no identity", p, "identities from 0");
    }
    return keep;
}

void TrajectoryFile::State::fail(const Snapshot& snapshot, const std::string& actual,
                                 std::size_t particle, const std::string& expected) const {
    file.fail(fmt::format("{}, frame {}, {}: {}", positions.path(), snapshot.frame,
                          particle_name(snapshot, particle), actual),
              expected);
}

void TrajectoryFile::State::open_box(const H5Group& particles) {
    const H5Group box = particles.group("box");
    const std::vector<std::string> names = box.texts_attribute("boundary");
    if (names.empty()) file.fail("the box has no boundary");
    boundary = {boundary_of(file, names.front()), boundary_of(file, names.at(names.size() > 1))};
    if (box.has_attribute("edges")) {
        fixed_edges = box.numbers_attribute("edges");
    } else if (box.has_group("edges")) {
        edges = box.group("edges").dataset("value");
        require_frames(edges);
    } else {
        fixed_edges = box.dataset("edges").read<double>();
    }
}

void TrajectoryFile::State::read_own(const H5Group& root) {
    if (!root.has("parameters")) return;
    const H5Group parameters = root.group("parameters");
    if (!parameters.has("grainfield")) return;
    const H5Group own = parameters.group("grainfield");
    if (const double version = own.number_attribute("version"); version != trajectory_version) {
        file.fail(fmt::format("a trajectory of format version {}", version),
                  fmt::format("version {}", trajectory_version));
    }
    const nlohmann::json description = parse_json(own.text("info"), file.name());
    info = info_from_json(description, file.name());
    // A run that was killed has left frames, but no record.
    if (own.has("record")) {
        record = record_from_json(parse_json(own.text("record"), file.name()), file.name());
    }
    if (!names_identity(description)) add_legacy_identity(info, record);
    previews = read_previews(own.group("previews"));
    if (own.has_group("curves")) curves = read_curves(own.group("curves"));
    present = own.dataset("columns").read<std::uint8_t>();
    box_origin = own.dataset("box_origin").read<double>();
    box_height = own.dataset("box_height").read<double>();
    if (present.size() < frames || box_origin.size() / 2 < frames || box_height.size() < frames) {
        file.fail("/parameters/grainfield does not cover all frames");
    }
}

void TrajectoryFile::State::open_columns(const H5Group& particles) {
    for (const TrajectoryColumn column : all_columns) {
        const std::string name = trajectory_column_names[index_of(column)];
        if (column == TrajectoryColumn::z || !particles.has(name)) continue;
        columns[index_of(column)] = particles.group(name).dataset("value");
        require_frames(columns[index_of(column)]);
    }
}

void TrajectoryFile::State::require_frames(const H5Dataset& data) const {
    const H5Extent extent = data.extent();
    if (!extent.empty() && extent[0] >= frames) return;
    file.fail(fmt::format("{} has the extent {}", data.path(), data.extent_text()),
              fmt::format("{} frames", frames));
}

Box TrajectoryFile::State::box(hsize_t frame) const {
    const std::vector<double> values = edges ? edges.read_row<double>(frame) : fixed_edges;
    const std::size_t entries = values.size();
    Box box;
    box.boundary = boundary;
    if (entries == 2 || entries == 3) {
        box.length = {values[0], values[1]};
        if (entries == 3) box.height = values[2];
    } else if (entries == 4 || entries == 9) {
        const std::size_t n = entries == 4 ? 2 : 3;
        for (std::size_t i = 0; i < entries; ++i) {
            if (i % (n + 1) != 0 && values[i] != 0) file.fail("the box is not rectangular");
        }
        box.length = {values[0], values[n + 1]};
        if (n == 3) box.height = values[8];
    } else {
        file.fail(fmt::format("the box has {} numbers", entries), "2, 3, 4 or 9");
    }
    if (!box_height.empty()) {
        const auto i = static_cast<std::size_t>(frame);
        box.height = box_height[i];
        box.origin = {box_origin[2 * i], box_origin[2 * i + 1]};
    }
    try {
        require_valid(box);
    } catch (const OptionError& error) {
        file.fail(error.what());
    }
    return box;
}

bool TrajectoryFile::State::has(TrajectoryColumn column, hsize_t frame) const {
    if (present.empty()) return true;
    return (present[static_cast<std::size_t>(frame)] & bit_of(column)) != 0;
}

template <class T>
std::vector<T> TrajectoryFile::State::row(TrajectoryColumn column, hsize_t frame,
                                          hsize_t width) const {
    const H5Dataset& data = columns[index_of(column)];
    if (!data || !has(column, frame)) return {};
    std::vector<T> values = data.read_row<T>(frame);
    // The sizes stand in the file: a product of them may overflow.
    if (values.size() % width != 0 || values.size() / width != most_particles) {
        file.fail(fmt::format("{} has {} numbers in frame {}", data.path(), values.size(), frame),
                  fmt::format("{} for each of {} particles", width, most_particles));
    }
    return values;
}

Snapshot TrajectoryFile::State::read(hsize_t frame) {
    const auto i = static_cast<std::size_t>(frame);
    const auto width = static_cast<std::size_t>(dimensions);
    Snapshot snapshot;
    snapshot.frame = step[i];
    snapshot.time = time[i];
    snapshot.box = box(frame);
    const std::vector<double> numbers = positions.read_row<double>(frame);
    snapshot.position = vec2s(numbers, width);
    if (width == 3 && has(TrajectoryColumn::z, frame)) {
        snapshot.z.resize(snapshot.size());
        for (std::size_t p = 0; p < snapshot.size(); ++p) snapshot.z[p] = numbers[3 * p + 2];
    }
    snapshot.id = row<std::int64_t>(TrajectoryColumn::id, frame, 1);
    const hsize_t velocity_width = present.empty() ? dimensions : 3;
    if (velocity_width == 3) {
        snapshot.velocity = vec3s(row<double>(TrajectoryColumn::velocity, frame, 3));
    } else {
        for (const Vec2 v : vec2s(row<double>(TrajectoryColumn::velocity, frame, 2), 2)) {
            snapshot.velocity.push_back({v.x, v.y, 0});
        }
    }
    if (!present.empty()) {
        snapshot.spin = vec3s(row<double>(TrajectoryColumn::spin, frame, 3));
        snapshot.position_error = vec2s(row<double>(TrajectoryColumn::position_error, frame, 2), 2);
        snapshot.z_error = row<double>(TrajectoryColumn::z_error, frame, 1);
        snapshot.quality = row<double>(TrajectoryColumn::quality, frame, 1);
        snapshot.layer = layers(row<std::int8_t>(TrajectoryColumn::layer, frame, 1));
    }
    const std::vector<bool> keep = particles_of(snapshot);
    keep_rows(snapshot.id, keep);
    keep_rows(snapshot.z, keep);
    keep_rows(snapshot.velocity, keep);
    keep_rows(snapshot.spin, keep);
    keep_rows(snapshot.position_error, keep);
    keep_rows(snapshot.z_error, keep);
    keep_rows(snapshot.quality, keep);
    keep_rows(snapshot.layer, keep);
    keep_rows(snapshot.position, keep);
    if (const auto flaw = check.flaw_of(snapshot)) {
        fail(snapshot, flaw->actual, flaw->particle, flaw->expected);
    }
    require_consistent(snapshot);
    return snapshot;
}

TrajectoryFile::TrajectoryFile(const std::filesystem::path& path)
    : state_(std::make_unique<State>(path)) {}

TrajectoryFile::~TrajectoryFile() = default;
TrajectoryFile::TrajectoryFile(TrajectoryFile&&) noexcept = default;

const TrajectoryInfo& TrajectoryFile::info() const {
    return state_->info;
}

std::int64_t TrajectoryFile::count() const {
    return static_cast<std::int64_t>(state_->frames);
}

Snapshot TrajectoryFile::read(std::int64_t index) {
    if (index < 0 || index >= count()) {
        throw OptionError(
            {.problem = fmt::format("'{}' has no frame {}", state_->file.name(), index),
             .actual = {},
             .expected = fmt::format("0 … {}", count() - 1),
             .suggestion = {}});
    }
    return state_->read(static_cast<hsize_t>(index));
}

const std::vector<Preview>& TrajectoryFile::previews() const {
    return state_->previews;
}

const std::vector<Curve>& TrajectoryFile::curves() const {
    return state_->curves;
}

const RunRecord& TrajectoryFile::record() const {
    return state_->record;
}

std::int64_t TrajectoryFile::frames_left_out() const {
    return state_->left_out;
}

}  // namespace grainfield::io
