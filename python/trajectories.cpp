#include "python/trajectories.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/trajectory.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "python/released.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

using SharedTrajectory = std::shared_ptr<Trajectory>;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const char* origin_text(Origin origin) {
    switch (origin) {
        case Origin::video:
            return "video";
        case Origin::md:
            return "md";
        case Origin::rendered:
            return "rendered";
        case Origin::points:
            return "points";
        case Origin::field:
            return "field";
    }
    return "";
}

const char* text_of(DiameterOrigin origin) {
    switch (origin) {
        case DiameterOrigin::stated:
            return "stated";
        case DiameterOrigin::simulated:
            return "simulated";
        case DiameterOrigin::given:
            return "given";
        case DiameterOrigin::apparent:
            return "apparent";
    }
    return "";
}

py::dict dict_of(const Box& box) {
    const auto name = [](Boundary b) { return b == Boundary::periodic ? "periodic" : "walls"; };
    py::dict dict;
    dict["origin"] = py::make_tuple(box.origin.x, box.origin.y);
    dict["length"] = py::make_tuple(box.length.x, box.length.y);
    dict["boundary"] = py::make_tuple(name(box.boundary[0]), name(box.boundary[1]));
    dict["height"] = box.height;
    return dict;
}

py::dict info_of(const Trajectory& trajectory) {
    const TrajectoryInfo& info = trajectory.info;
    py::dict dict;
    dict["origin"] = origin_text(info.origin);
    dict["length_unit"] = info.length_unit == LengthUnit::pixel ? "px" : "a";
    dict["time_unit"] = plain_text(info.time_unit);
    dict["diameter"] = info.diameter;
    dict["diameter_origin"] = text_of(info.diameter_origin);
    dict["frame_rate"] = info.frame_rate;
    dict["vibration_frequency"] = info.vibration_frequency;
    dict["source"] = info.source;
    dict["box"] = trajectory.snapshots.empty() ? py::object(py::none())
                                               : dict_of(trajectory.snapshots.front().box);
    return dict;
}

/// A column of a snapshot as an array of doubles that shares its memory; read-only.
template <class T>
py::object view(const std::vector<T>& column, py::ssize_t width, const py::object& owner) {
    if (column.empty()) return py::none();
    static_assert(sizeof(T) % sizeof(double) == 0);
    const auto rows = static_cast<py::ssize_t>(column.size());
    const auto* data = reinterpret_cast<const double*>(column.data());
    py::array_t<double> array =
        width == 1 ? py::array_t<double>({rows}, {sizeof(T)}, data, owner)
                   : py::array_t<double>({rows, width}, {sizeof(T), sizeof(double)}, data, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

py::array_t<double> no_positions() {
    return py::array_t<double>(std::vector<py::ssize_t>{0, 2});
}

py::dict snapshot_views(const SharedTrajectory& trajectory, std::int64_t index) {
    const auto count = static_cast<std::int64_t>(trajectory->snapshots.size());
    if (index < 0) index += count;
    if (index < 0 || index >= count) throw py::index_error("there is no such snapshot");
    const Snapshot& snapshot = trajectory->snapshots[static_cast<std::size_t>(index)];
    const py::object owner = py::cast(trajectory);
    py::dict views;
    views["frame"] = snapshot.frame;
    views["time"] = snapshot.time;
    views["box"] = dict_of(snapshot.box);
    views["position"] =
        snapshot.position.empty() ? py::object(no_positions()) : view(snapshot.position, 2, owner);
    views["position_error"] = view(snapshot.position_error, 2, owner);
    views["z"] = view(snapshot.z, 1, owner);
    views["velocity"] = view(snapshot.velocity, 3, owner);
    views["spin"] = view(snapshot.spin, 3, owner);
    views["quality"] = view(snapshot.quality, 1, owner);
    views["particle"] = py::none();
    if (!snapshot.id.empty()) {
        py::array_t<std::int64_t> ids(static_cast<py::ssize_t>(snapshot.id.size()),
                                      snapshot.id.data(), owner);
        ids.attr("flags").attr("writeable") = false;
        views["particle"] = ids;
    }
    return views;
}

/// One value for each particle of all snapshots, those without the column as `missing`; nothing if
/// no snapshot has it.
template <class T, class Column, class Value>
void add_column(py::dict& columns, const char* name, const Trajectory& trajectory,
                const Column& column, const Value& value, T missing) {
    std::size_t rows = 0;
    bool is_there = false;
    for (const Snapshot& snapshot : trajectory.snapshots) {
        rows += snapshot.size();
        is_there = is_there || !column(snapshot).empty();
    }
    if (!is_there) return;
    py::array_t<T> array(static_cast<py::ssize_t>(rows));
    T* to = array.mutable_data();
    for (const Snapshot& snapshot : trajectory.snapshots) {
        const auto& from = column(snapshot);
        if (from.empty()) {
            to = std::fill_n(to, snapshot.size(), missing);
        } else {
            to = std::transform(from.begin(), from.end(), to, value);
        }
    }
    columns[name] = std::move(array);
}

py::dict columns_of(const Trajectory& trajectory) {
    py::dict columns;
    std::size_t rows = 0;
    for (const Snapshot& snapshot : trajectory.snapshots) rows += snapshot.size();
    py::array_t<std::int64_t> frame(static_cast<py::ssize_t>(rows));
    std::int64_t* to = frame.mutable_data();
    for (const Snapshot& s : trajectory.snapshots) to = std::fill_n(to, s.size(), s.frame);
    const auto position = [](const Snapshot& s) -> const auto& {
        return s.position;
    };
    const auto error = [](const Snapshot& s) -> const auto& {
        return s.position_error;
    };
    const auto velocity = [](const Snapshot& s) -> const auto& {
        return s.velocity;
    };
    const auto itself = [](auto v) { return v; };
    columns["x"] = py::array_t<double>(0);
    columns["y"] = py::array_t<double>(0);
    add_column(
        columns, "x", trajectory, position, [](Vec2 p) { return p.x; }, nan);
    add_column(
        columns, "y", trajectory, position, [](Vec2 p) { return p.y; }, nan);
    add_column(
        columns, "z", trajectory, [](const Snapshot& s) -> const auto& { return s.z; }, itself,
        nan);
    columns["frame"] = std::move(frame);
    add_column(
        columns, "particle", trajectory, [](const Snapshot& s) -> const auto& { return s.id; },
        itself, std::int64_t{-1});
    add_column(
        columns, "x_std", trajectory, error, [](Vec2 e) { return e.x; }, nan);
    add_column(
        columns, "y_std", trajectory, error, [](Vec2 e) { return e.y; }, nan);
    add_column(
        columns, "vx", trajectory, velocity, [](const Vec3& v) { return v.x; }, nan);
    add_column(
        columns, "vy", trajectory, velocity, [](const Vec3& v) { return v.y; }, nan);
    add_column(
        columns, "vz", trajectory, velocity, [](const Vec3& v) { return v.z; }, nan);
    add_column(
        columns, "layer", trajectory, [](const Snapshot& s) -> const auto& { return s.layer; },
        [](Layer l) { return static_cast<std::int8_t>(l); }, std::int8_t{-1});
    add_column(
        columns, "quality", trajectory, [](const Snapshot& s) -> const auto& { return s.quality; },
        itself, nan);
    return columns;
}

py::tuple frames_and_times(const Trajectory& trajectory) {
    const auto count = static_cast<py::ssize_t>(trajectory.snapshots.size());
    py::array_t<std::int64_t> frames(count);
    py::array_t<double> times(count);
    for (std::size_t i = 0; i < trajectory.snapshots.size(); ++i) {
        frames.mutable_data()[i] = trajectory.snapshots[i].frame;
        times.mutable_data()[i] = trajectory.snapshots[i].time;
    }
    return py::make_tuple(frames, times);
}

/// What the points of from_points are given with.
struct PointsAre {
    std::optional<std::array<double, 4>> box;  ///< x, y of the corner, lengths
    bool is_periodic = false;
    double diameter = 1;
    bool is_in_pixels = false;
    std::optional<double> frame_rate;
};

Box box_of(const PointsAre& is, const Numbers& position) {
    Box box;
    if (is.box) {
        box = {.origin = {(*is.box)[0], (*is.box)[1]}, .length = {(*is.box)[2], (*is.box)[3]}};
    } else {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        Vec2 low{infinite, infinite};
        Vec2 high = -1.0 * low;
        for (py::ssize_t i = 0; i < position.shape(0); ++i) {
            const Vec2 p{position.at(i, 0), position.at(i, 1)};
            if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
            low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y)};
            high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y)};
        }
        box = {.origin = low, .length = high - low};
    }
    if (is.is_periodic) box.boundary = {Boundary::periodic, Boundary::periodic};
    require_valid(box);
    return box;
}

void require_points(const Integers& frame, const Numbers& position,
                    const std::optional<Integers>& particle) {
    if (position.ndim() != 2 || position.shape(1) != 2 || position.shape(0) == 0) {
        throw InputError({"these are not positions", py::str(position.attr("shape")),
                          "an array of shape (N, 2), not empty", ""});
    }
    if (frame.ndim() != 1 || frame.shape(0) != position.shape(0) ||
        (particle && (particle->ndim() != 1 || particle->shape(0) != position.shape(0)))) {
        throw InputError({"columns of points have different lengths",
                          fmt::format("{} frames", frame.size()),
                          fmt::format("{}, as there are positions", position.shape(0)), ""});
    }
}

/// Points in order of their frames.
SharedTrajectory from_points(const Integers& frame, const Numbers& position,
                             const std::optional<Integers>& particle, const PointsAre& is) {
    require_points(frame, position, particle);
    auto trajectory = std::make_shared<Trajectory>();
    TrajectoryInfo& info = trajectory->info;
    info.length_unit = is.is_in_pixels ? LengthUnit::pixel : LengthUnit::diameter;
    info.time_unit = is.frame_rate ? TimeUnit::second : TimeUnit::frame;
    info.diameter = is.diameter;
    info.frame_rate = is.frame_rate;
    info.source = "arrays";
    const Box box = box_of(is, position);
    for (py::ssize_t i = 0; i < position.shape(0); ++i) {
        std::vector<Snapshot>& snapshots = trajectory->snapshots;
        if (snapshots.empty() || snapshots.back().frame != frame.at(i)) {
            if (!snapshots.empty() && snapshots.back().frame > frame.at(i)) {
                throw InputError({"points are out of order", fmt::format("frame {}", frame.at(i)),
                                  fmt::format("one from {} on", snapshots.back().frame),
                                  "sort them by frame"});
            }
            Snapshot& next = snapshots.emplace_back();
            next.frame = frame.at(i);
            next.time = static_cast<double>(next.frame) / is.frame_rate.value_or(1);
            next.box = box;
        }
        snapshots.back().position.push_back({position.at(i, 0), position.at(i, 1)});
        if (particle) snapshots.back().id.push_back(particle->at(i));
    }
    return trajectory;
}

SharedTrajectory read(const std::filesystem::path& path) {
    auto trajectory = std::make_shared<Trajectory>();
    run_released([trajectory, path] {
        const auto source = io::open_snapshots(path, std::nullopt, TrajectoryInfo{});
        trajectory->info = source->info();
        for (std::int64_t i = 0; i < source->count(); ++i) {
            throw_if_interrupted("reading");
            trajectory->snapshots.push_back(source->read(i));
        }
    });
    return trajectory;
}

void save(const SharedTrajectory& trajectory, const std::filesystem::path& path, bool overwrite,
          const std::string& version) {
    run_released([trajectory, path, overwrite, version] {
        io::TrajectoryWriter writer(path, trajectory->info,
                                    overwrite ? Overwrite::force : Overwrite::refuse);
        for (const Snapshot& snapshot : trajectory->snapshots) {
            throw_if_interrupted("writing");
            writer.write(snapshot);
        }
        RunRecord record;
        record.command = "python";
        record.version = version;
        writer.finish(record);
    });
}

}  // namespace

void bind_trajectories(py::module_& module) {
    py::class_<Trajectory, SharedTrajectory>(module, "Trajectory")
        .def("__len__", [](const Trajectory& t) { return t.snapshots.size(); })
        .def("info", &info_of)
        .def("columns", &columns_of)
        .def("snapshot", &snapshot_views, py::arg("index"))
        .def("frames_and_times", &frames_and_times)
        .def("save", &save, py::arg("path"), py::arg("overwrite"), py::arg("version"));
    module.def(
        "trajectory_from_points",
        [](const Integers& frame, const Numbers& position, const std::optional<Integers>& particle,
           std::optional<std::array<double, 4>> box, bool periodic, double diameter, bool pixels,
           std::optional<double> fps) {
            return from_points(frame, position, particle, {box, periodic, diameter, pixels, fps});
        },
        py::arg("frame"), py::arg("position"), py::arg("particle"), py::arg("box"),
        py::arg("periodic"), py::arg("diameter"), py::arg("pixels"), py::arg("fps"));
    module.def("read_trajectory", &read, py::arg("path"));
}

}  // namespace grainfield::python
