#include "io/text/points_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

namespace {

constexpr std::size_t absent = std::numeric_limits<std::size_t>::max();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const auto begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return {};
    text = text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
        return trimmed(text.substr(1, text.size() - 2));
    }
    return text;
}

// Splits at commas outside quotes.
void split(std::string_view line, std::vector<std::string_view>& fields) {
    fields.clear();
    bool quoted = false;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i < line.size() && line[i] == '"') quoted = !quoted;
        if (i < line.size() && (line[i] != ',' || quoted)) continue;
        fields.push_back(trimmed(line.substr(begin, i - begin)));
        begin = i + 1;
    }
}

std::string lower(std::string_view text) {
    std::string word(text);
    std::ranges::transform(word, word.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return word;
}

bool is_missing(std::string_view text) {
    return text.empty() || lower(text) == "nan";
}

}  // namespace

const std::array<std::string_view, PointsLine::field_count> PointsLine::names{
    "frame", "particle", "x", "y", "z", "x_std", "y_std", "z_std", "layer", "quality"};

bool PointsLine::is_blank(std::string_view line) {
    const std::string_view content = trimmed(line);
    return content.empty() || content.front() == '#';
}

void PointsLine::fail(std::int64_t line, const std::string& actual,
                      const std::string& expected) const {
    const std::string where = line > 0 ? fmt::format(", line {}", line) : std::string();
    throw InputError({.problem = fmt::format("cannot read '{}'{}", path_.string(), where),
                      .actual = actual,
                      .expected = expected,
                      .suggestion = {}});
}

void PointsLine::read_header(std::string_view line, std::int64_t number) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
    split(line, fields_);
    column_.fill(absent);
    length_unit_.reset();
    std::size_t in_pixels = 0;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        std::string name = lower(fields_[i]);
        if (name == "x_px" || name == "y_px") {
            name.resize(1);
            ++in_pixels;
        }
        const auto known = std::ranges::find(names, name);
        if (known == names.end()) continue;
        take_column(static_cast<Field>(known - names.begin()), i, number);
    }
    for (const Field needed : {frame, x, y}) {
        if (has(needed) || (needed == frame && frames_ == FrameColumn::optional)) continue;
        fail(number, fmt::format("there is no column '{}' in the header", names[needed]),
             fmt::format("columns {}x,y (or x_px,y_px) and where they apply "
                         "particle,z,x_std,y_std,z_std,layer,quality",
                         frames_ == FrameColumn::optional ? "" : "frame,"));
    }
    if (in_pixels == 1) {
        fail(number, "one of x and y is in pixels", "x,y or x_px,y_px");
    }
    if (in_pixels > 0) length_unit_ = LengthUnit::pixel;
}

void PointsLine::take_column(Field field, std::size_t index, std::int64_t line) {
    if (has(field)) fail(line, fmt::format("column '{}' occurs twice", names[field]));
    column_[field] = index;
}

bool PointsLine::has(Field field) const {
    return column_[field] != absent;
}

std::string_view PointsLine::text(Field field) const {
    if (column_[field] < fields_.size()) return fields_[column_[field]];
    fail(line_, fmt::format("{} fields", fields_.size()),
         fmt::format("at least {}, up to column '{}'", column_[field] + 1, names[field]));
}

double PointsLine::number(Field field) const {
    std::string_view digits = text(field);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
        fail(line_, fmt::format("{} is '{}'", names[field], text(field)), "a number");
    }
    return value;
}

double PointsLine::number_or_missing(Field field) const {
    return !has(field) || is_missing(text(field)) ? nan : number(field);
}

std::int64_t PointsLine::integer(Field field) const {
    constexpr double exact_integers = 9007199254740992.0;  // 2^53
    const std::string_view digits = text(field);
    std::int64_t whole = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), whole);
    if (error == std::errc() && end == digits.data() + digits.size()) {
        if (whole >= 0) return whole;
    } else if (const double value = number(field);
               value >= 0 && value < exact_integers && value == std::floor(value)) {
        return static_cast<std::int64_t>(value);
    }
    fail(line_, fmt::format("{} is '{}'", names[field], digits), "a whole number from 0");
}

Point PointsLine::read(std::string_view line, std::int64_t number_of_line) {
    line_ = number_of_line;
    split(line, fields_);
    Point point;
    if (has(frame)) point.frame = integer(frame);
    point.position = {number(x), number(y)};
    if (has(particle) && !is_missing(text(particle))) point.particle = integer(particle);
    point.z = number_or_missing(z);
    point.position_error = {number_or_missing(x_std), number_or_missing(y_std)};
    point.z_error = number_or_missing(z_std);
    point.quality = number_or_missing(quality);
    point.layer = number_or_missing(layer);
    return point;
}

void PointsLine::append(const Point& point, Snapshot& snapshot) const {
    snapshot.position.push_back(point.position);
    if (has(particle)) snapshot.id.push_back(point.particle);
    if (has(z)) snapshot.z.push_back(point.z);
    if (has(x_std) || has(y_std)) snapshot.position_error.push_back(point.position_error);
    if (has(z_std)) snapshot.z_error.push_back(point.z_error);
    if (has(quality)) snapshot.quality.push_back(point.quality);
    if (has(layer)) {
        const double level = point.layer - first_layer_;
        snapshot.layer.push_back(level == 0 || level == 1 ? static_cast<Layer>(level)
                                                          : Layer::unknown);
    }
}

}  // namespace grainfield::io
