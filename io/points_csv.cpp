#include "io/points_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/snapshot.h"

namespace grainfield::io {

namespace {

enum Field : std::size_t { frame, particle, x, y, z, x_std, y_std, layer, quality, field_count };

constexpr std::array<std::string_view, field_count> field_names{
    "frame", "particle", "x", "y", "z", "x_std", "y_std", "layer", "quality"};

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

class PointsReader {
 public:
    explicit PointsReader(std::filesystem::path path) : path_(std::move(path)) {}

    std::map<std::int64_t, Snapshot> read();

 private:
    [[noreturn]] void fail(const std::string& actual, const std::string& expected = {}) const;
    void read_header(std::string_view line);
    void read_line(std::string_view line);
    std::string_view text(Field field) const;
    double number(Field field) const;
    double number_or_missing(Field field) const;
    std::int64_t integer(Field field) const;
    bool has(Field field) const { return column_[field] != absent; }

    std::filesystem::path path_;
    std::int64_t line_ = 0;
    std::array<std::size_t, field_count> column_{};
    std::vector<std::string_view> fields_;
    std::map<std::int64_t, Snapshot> snapshots_;
};

void PointsReader::fail(const std::string& actual, const std::string& expected) const {
    const std::string where = line_ > 0 ? fmt::format(", line {}", line_) : std::string();
    throw InputError({.problem = fmt::format("cannot read '{}'{}", path_.string(), where),
                      .actual = actual,
                      .expected = expected,
                      .suggestion = {}});
}

void PointsReader::read_header(std::string_view line) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
    split(line, fields_);
    column_.fill(absent);
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        const auto known = std::ranges::find(field_names, lower(fields_[i]));
        if (known == field_names.end()) continue;
        std::size_t& column = column_[static_cast<std::size_t>(known - field_names.begin())];
        if (column != absent) fail(fmt::format("column '{}' occurs twice", *known));
        column = i;
    }
    for (const Field needed : {frame, x, y}) {
        if (has(needed)) continue;
        fail(fmt::format("there is no column '{}' in the header", field_names[needed]),
             "columns frame,x,y and where they apply particle,z,x_std,y_std,layer,quality");
    }
}

std::string_view PointsReader::text(Field field) const {
    if (column_[field] < fields_.size()) return fields_[column_[field]];
    fail(fmt::format("{} fields", fields_.size()),
         fmt::format("at least {}, up to column '{}'", column_[field] + 1, field_names[field]));
}

double PointsReader::number(Field field) const {
    std::string_view digits = text(field);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
        fail(fmt::format("{} is '{}'", field_names[field], text(field)), "a number");
    }
    return value;
}

double PointsReader::number_or_missing(Field field) const {
    const std::string_view field_text = text(field);
    if (field_text.empty() || lower(field_text) == "nan") return nan;
    return number(field);
}

std::int64_t PointsReader::integer(Field field) const {
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
    fail(fmt::format("{} is '{}'", field_names[field], digits), "a whole number from 0");
}

void PointsReader::read_line(std::string_view line) {
    split(line, fields_);
    const std::int64_t index = integer(frame);
    Snapshot& snapshot = snapshots_[index];
    snapshot.frame = index;
    snapshot.position.push_back({number(x), number(y)});
    if (has(particle)) snapshot.id.push_back(integer(particle));
    if (has(z)) snapshot.z.push_back(number_or_missing(z));
    if (has(x_std) || has(y_std)) {
        snapshot.position_error.push_back({has(x_std) ? number_or_missing(x_std) : nan,
                                           has(y_std) ? number_or_missing(y_std) : nan});
    }
    if (has(quality)) snapshot.quality.push_back(number_or_missing(quality));
    if (has(layer)) {
        const double level = number_or_missing(layer);
        snapshot.layer.push_back(level == 0   ? Layer::bottom
                                 : level == 1 ? Layer::top
                                              : Layer::unknown);
    }
}

std::map<std::int64_t, Snapshot> PointsReader::read() {
    std::error_code error;
    if (std::filesystem::is_directory(path_, error)) fail("a folder", "a table of points");
    std::ifstream file(path_, std::ios::binary);
    if (!file) {
        fail(std::filesystem::exists(path_, error) ? "it may not be read" : "no such file");
    }
    bool in_header = true;
    for (std::string line; std::getline(file, line);) {
        ++line_;
        const std::string_view content = trimmed(line);
        if (content.empty() || content.front() == '#') continue;
        if (in_header) {
            read_header(line);
        } else {
            read_line(line);
        }
        in_header = false;
    }
    line_ = 0;
    if (file.bad()) fail("reading stopped in the middle");
    if (in_header) fail("the file is empty", "a header line and one line per point");
    return std::move(snapshots_);
}

Box bounding_box(const std::vector<Snapshot>& snapshots, double diameter) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec2 low{infinity, infinity};
    Vec2 high{-infinity, -infinity};
    for (const Snapshot& snapshot : snapshots) {
        for (const Vec2 p : snapshot.position) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
    }
    if (snapshots.empty()) low = high = {0, 0};
    // Points on one line still need a cell with an area.
    const Vec2 length = high - low;
    return {.origin = low,
            .length = {length.x > 0 ? length.x : diameter, length.y > 0 ? length.y : diameter}};
}

class PointsTable : public SnapshotSource {
 public:
    PointsTable(TrajectoryInfo info, std::vector<Snapshot> snapshots)
        : info_(std::move(info)), snapshots_(std::move(snapshots)) {}

    const TrajectoryInfo& info() const override { return info_; }
    std::int64_t count() const override { return static_cast<std::int64_t>(snapshots_.size()); }
    Snapshot read(std::int64_t index) override {
        if (index < 0 || index >= count()) {
            throw OptionError({.problem = fmt::format("'{}' has no entry {}", info_.source, index),
                               .actual = {},
                               .expected = fmt::format("0 … {}", count() - 1),
                               .suggestion = {}});
        }
        return snapshots_[static_cast<std::size_t>(index)];
    }

 private:
    TrajectoryInfo info_;
    std::vector<Snapshot> snapshots_;
};

}  // namespace

std::unique_ptr<SnapshotSource> open_points(const std::filesystem::path& path,
                                            const std::optional<Box>& box,
                                            const TrajectoryInfo& hints) {
    if (box) require_valid(*box);
    TrajectoryInfo info = hints;
    if (info.source.empty()) info.source = path.filename().string();
    std::vector<Snapshot> snapshots;
    for (auto& [index, snapshot] : PointsReader(path).read()) {
        snapshots.push_back(std::move(snapshot));
    }
    const Box cell = box ? *box : bounding_box(snapshots, info.diameter);
    for (Snapshot& snapshot : snapshots) {
        snapshot.box = cell;
        snapshot.time = static_cast<double>(snapshot.frame) / info.frame_rate.value_or(1);
    }
    return std::make_unique<PointsTable>(std::move(info), std::move(snapshots));
}

}  // namespace grainfield::io
