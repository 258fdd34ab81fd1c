#include "io/text/points_statement.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/text/number_text.h"

namespace grainfield::io {

namespace {

constexpr std::string_view title = "grainfield points 1";

template <class Enum, std::size_t n>
using Names = std::array<std::pair<Enum, std::string_view>, n>;

constexpr Names<LengthUnit, 2> length_units{
    {{LengthUnit::pixel, "pixel"}, {LengthUnit::diameter, "diameter"}}};
constexpr Names<TimeUnit, 3> time_units{{{TimeUnit::frame, "frame"},
                                         {TimeUnit::second, "second"},
                                         {TimeUnit::sqrt_a_over_g, "sqrt(a/g)"}}};
constexpr Names<Origin, 4> origins{{{Origin::video, "video"},
                                    {Origin::md, "md"},
                                    {Origin::rendered, "rendered"},
                                    {Origin::points, "points"}}};
constexpr Names<Boundary, 2> boundaries{
    {{Boundary::walls, "walls"}, {Boundary::periodic, "periodic"}}};

template <class Enum, std::size_t n>
std::string_view name_of(Enum value, const Names<Enum, n>& names) {
    return std::ranges::find(names, value, &std::pair<Enum, std::string_view>::first)->second;
}

// Returns what is wrong, empty if nothing.
template <class Enum, std::size_t n>
std::string set_by_name(Enum& value, std::string_view name, const Names<Enum, n>& names) {
    const auto known = std::ranges::find(names, name, &std::pair<Enum, std::string_view>::second);
    if (known == names.end()) return fmt::format("'{}' is not known here", name);
    value = known->first;
    return {};
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r,";
    const auto begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        parts.push_back(trimmed(text.substr(begin, end - begin)));
        begin = end + 1;
    }
    return parts;
}

template <class Number>
std::optional<Number> parse(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    if (!std::isfinite(static_cast<double>(value))) return std::nullopt;
    return value;
}

std::string set_positive(std::optional<double>& number, std::string_view text) {
    const auto value = parse<double>(text);
    if (!value || *value <= 0) return fmt::format("'{}' is not a positive number", text);
    number = value;
    return {};
}

std::string set_box(std::optional<Box>& box, std::string_view text) {
    auto wrong = fmt::format("'{}' is not a box X0,Y0,LX,LY,HEIGHT", text);
    std::vector<double> numbers;
    for (const std::string_view part : parts_of(text, ',')) {
        const auto number = parse<double>(part);
        if (!number) return wrong;
        numbers.push_back(*number);
    }
    if (numbers.size() != 5 || numbers[2] <= 0 || numbers[3] <= 0 || numbers[4] < 0) return wrong;
    if (!box) box.emplace();
    box->origin = {numbers[0], numbers[1]};
    box->length = {numbers[2], numbers[3]};
    box->height = numbers[4];
    return {};
}

void append_line(std::string& text, std::string_view key, double number) {
    text += fmt::format("# {}: ", key);
    append_number(text, number);
    text += '\n';
}

double time_by_rate(std::int64_t frame, const TrajectoryInfo& info) {
    return static_cast<double>(frame) / info.frame_rate.value_or(1);
}

}  // namespace

std::filesystem::path statement_path(const std::filesystem::path& table) {
    std::filesystem::path path = table;
    path += ".meta";
    return path;
}

std::string text_of(const PointsStatement& statement) {
    const TrajectoryInfo& info = statement.info;
    std::string text =
        fmt::format("# {}\n# origin: {}\n# length_unit: {}\n# time_unit: {}\n", title,
                    name_of(info.origin, origins), name_of(info.length_unit, length_units),
                    name_of(info.time_unit, time_units));
    append_line(text, "diameter", info.diameter);
    if (info.frame_rate) append_line(text, "frame_rate", *info.frame_rate);
    if (info.vibration_frequency) {
        append_line(text, "vibration_frequency", *info.vibration_frequency);
    }
    if (statement.box) {
        const Box& box = *statement.box;
        text += "# box: ";
        for (const double number : {box.origin.x, box.origin.y, box.length.x, box.length.y}) {
            append_number(text, number);
            text += ',';
        }
        append_number(text, box.height);
        text += fmt::format("\n# boundary: {},{}\n", name_of(box.boundary[0], boundaries),
                            name_of(box.boundary[1], boundaries));
    }
    return text;
}

std::string frame_comment(const Snapshot& snapshot, const TrajectoryInfo& info) {
    const double expected = time_by_rate(snapshot.frame, info);
    const bool is_expected =
        std::abs(snapshot.time - expected) <= 1e-14 * std::max(1.0, std::abs(expected));
    if (is_expected && snapshot.size() > 0) return {};
    std::string text = fmt::format("# frame {} time ", snapshot.frame);
    append_number(text, snapshot.time);
    return text + "\n";
}

std::string PointsStatementReader::take_frame(std::string_view text) {
    const auto parts = parts_of(text, ' ');
    if (parts.size() == 4 && parts[2] == "time") {
        const auto frame = parse<std::int64_t>(parts[1]);
        const auto time = parse<double>(parts[3]);
        if (frame && time && *frame >= 0) {
            frame_time_ = {*frame, *time};
            return {};
        }
    }
    return fmt::format("'{}' is not 'frame NUMBER time NUMBER'", text);
}

std::string PointsStatementReader::take_value(std::string_view key, std::string_view value) {
    TrajectoryInfo& info = statement_.info;
    if (key == "origin") return set_by_name(info.origin, value, origins);
    if (key == "length_unit") return set_by_name(info.length_unit, value, length_units);
    if (key == "time_unit") return set_by_name(info.time_unit, value, time_units);
    if (key == "frame_rate") return set_positive(info.frame_rate, value);
    if (key == "vibration_frequency") return set_positive(info.vibration_frequency, value);
    if (key == "box") return set_box(statement_.box, value);
    if (key == "diameter") {
        std::optional<double> diameter;
        std::string wrong = set_positive(diameter, value);
        if (diameter) info.diameter = *diameter;
        statement_.has_diameter = diameter.has_value();
        return wrong;
    }
    if (key == "boundary") {
        const auto parts = parts_of(value, ',');
        if (!statement_.box || parts.size() != 2) return "boundaries need a box before them";
        std::string wrong = set_by_name(statement_.box->boundary[0], parts[0], boundaries);
        return wrong.empty() ? set_by_name(statement_.box->boundary[1], parts[1], boundaries)
                             : wrong;
    }
    return {};
}

std::string PointsStatementReader::take(std::string_view line) {
    frame_time_.reset();
    line = trimmed(line);
    if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    if (!line.starts_with('#')) return {};
    const std::string_view text = trimmed(line.substr(1));
    if (text == title) is_ours_ = true;
    if (!is_ours_) return {};
    if (text.starts_with("frame ")) return take_frame(text);
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return {};
    return take_value(trimmed(text.substr(0, colon)), trimmed(text.substr(colon + 1)));
}

}  // namespace grainfield::io
