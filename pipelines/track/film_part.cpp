#include "pipelines/track/film_part.h"

#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::pipelines {

namespace {

constexpr const char* part_name = "part";
constexpr const char* calibration_name = "part_calibration";
constexpr double kMostFrames = 9e15;  // whole numbers up to here are exact

/// Reads single numbers of a curve by their names.
class Numbers {
 public:
    Numbers(const Curve& curve, const std::filesystem::path& path) : curve_(curve), path_(path) {}

    double number(const std::string& name) const {
        const Column* column = curve_.find(name);
        if (column == nullptr || column->values.size() != 1) refuse(name, "no value");
        return column->values.front();
    }
    std::int64_t count(const std::string& name) const {
        const double value = number(name);
        if (!(value >= 0 && value < kMostFrames) || value != std::floor(value)) {
            refuse(name, fmt::format("{}", value));
        }
        return static_cast<std::int64_t>(value);
    }
    double length(const std::string& name) const {
        const double value = number(name);
        if (!std::isfinite(value)) refuse(name, fmt::format("{}", value));
        return value;
    }
    std::optional<double> known(const std::string& name) const {
        const double value = number(name);
        return std::isnan(value) ? std::nullopt : std::optional(value);
    }

 private:
    [[noreturn]] void refuse(const std::string& name, const std::string& actual) const {
        throw InputError(
            {.problem = fmt::format("'{}' is a damaged part of a film", path_.string()),
             .actual = fmt::format("'{}': {}", name, actual),
             .expected = {},
             .suggestion = "track the part again"});
    }

    const Curve& curve_;
    const std::filesystem::path& path_;
};

}  // namespace

std::optional<tracking::SphereCell> PartRecord::cell() const {
    if (!height || !sphere_diameter) return std::nullopt;
    return tracking::SphereCell{.diameter = *sphere_diameter,
                                .height = *height,
                                .camera_distance = camera_distance,
                                .axis = {0.5 * (size.x - 1), 0.5 * (size.y - 1)}};
}

std::vector<Curve> curves_of(const PartRecord& part) {
    const auto count = [](std::int64_t n) { return std::vector{static_cast<double>(n)}; };
    const auto known = [](const std::optional<double>& value) {
        return std::vector{value.value_or(std::numeric_limits<double>::quiet_NaN())};
    };
    return {{part_name,
             "Part of a film, to be linked",
             {{"begin", "-", "First frame, of those of the film", count(part.span.begin)},
              {"end", "-", "Frame after the last", count(part.span.end)},
              {"film_first", "-", "First frame of the film in its source", count(part.film.first)},
              {"film_step", "-", "Step between frames of the film", count(part.film.step)},
              {"film_frames", "-", "Frames of the film", count(part.film.count)},
              {"origin_x", "px", "Left side of the region", {part.origin.x}},
              {"origin_y", "px", "Upper side of the region", {part.origin.y}},
              {"width", "px", "Width of the region", {part.size.x}},
              {"height", "px", "Height of the region", {part.size.y}},
              {"disc_diameter", "px", "Apparent diameter D", {part.disc_diameter}},
              {"sphere_diameter", "px", "True diameter a", known(part.sphere_diameter)},
              {"cell_height", "a", "Distance of the plates", known(part.height)},
              {"camera_distance",
               "a",
               "Distance of the camera (0: telecentric)",
               {part.camera_distance}}},
             {}},
            {calibration_name,
             "Calibration of the film, to compare parts",
             {{"number", "-", "Number", part.calibration}},
             {}}};
}

std::optional<PartRecord> part_record(const io::TrajectoryFile& file,
                                      const std::filesystem::path& path) {
    const Curve* own = nullptr;
    const Curve* calibration = nullptr;
    for (const Curve& curve : file.curves()) {
        if (curve.name == part_name) own = &curve;
        if (curve.name == calibration_name) calibration = &curve;
    }
    if (own == nullptr) return std::nullopt;
    const Numbers numbers(*own, path);
    PartRecord part;
    part.span = {numbers.count("begin"), numbers.count("end")};
    part.film = {numbers.count("film_first"), numbers.count("film_step"),
                 numbers.count("film_frames")};
    if (part.span.end < part.span.begin || part.span.end > part.film.count || part.film.step < 1) {
        throw InputError({.problem = fmt::format("'{}' is a damaged part of a film", path.string()),
                          .actual = fmt::format("frames {} to {} of {}", part.span.begin,
                                                part.span.end, part.film.count),
                          .expected = {},
                          .suggestion = "track the part again"});
    }
    part.origin = {numbers.length("origin_x"), numbers.length("origin_y")};
    part.size = {numbers.length("width"), numbers.length("height")};
    part.disc_diameter = numbers.length("disc_diameter");
    part.sphere_diameter = numbers.known("sphere_diameter");
    part.height = numbers.known("cell_height");
    part.camera_distance = numbers.length("camera_distance");
    if (calibration != nullptr) {
        if (const Column* column = calibration->find("number")) part.calibration = column->values;
    }
    return part;
}

bool is_of_part(const Curve& curve) {
    return curve.name == part_name || curve.name == calibration_name;
}

}  // namespace grainfield::pipelines
