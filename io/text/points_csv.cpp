#include "io/text/points_csv.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/snapshot_check.h"
#include "core/support/interrupt.h"
#include "io/text/points_line.h"
#include "io/text/points_statement.h"

namespace grainfield::io {

namespace {

/// Neighbouring lines of one frame.
struct Piece {
    std::int64_t offset = 0;  ///< [bytes] of the first line
    std::int64_t line = 0;    ///< its number, from 1
    std::int64_t lines = 0;
};

struct IndexedFrame {
    std::vector<Piece> pieces;
    std::int64_t points = 0;
    std::int64_t unnamed = 0;    ///< points without an identity
    std::optional<double> time;  ///< where a comment says it
};

// The line of the n-th point of a frame, where no comments stand between its points.
std::int64_t line_of(const IndexedFrame& frame, std::size_t point) {
    auto before = static_cast<std::int64_t>(point);
    for (const Piece& piece : frame.pieces) {
        if (before < piece.lines) return piece.line + before;
        before -= piece.lines;
    }
    return 0;
}

/// Lines of a text file with their numbers and places.
class LineReader {
 public:
    LineReader(std::ifstream& file, const PointsLine& reader) : file_(file), reader_(reader) {}

    void jump(std::int64_t offset, std::int64_t line) {
        file_.clear();
        file_.seekg(offset);
        next_offset_ = offset;
        number_ = line - 1;
    }

    bool next() {
        offset_ = next_offset_;
        file_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        const auto taken = static_cast<std::size_t>(file_.gcount());
        if (taken == 0) return false;
        ++number_;
        if (file_.fail()) {
            reader_.fail(number_, fmt::format("a line of more than {} bytes", taken),
                         "a table of points");
        }
        next_offset_ += static_cast<std::int64_t>(taken);
        text_ = {buffer_.data(), taken - (file_.eof() ? 0 : 1)};
        return true;
    }

    std::string_view text() const { return text_; }
    std::int64_t number() const { return number_; }
    std::int64_t offset() const { return offset_; }

 private:
    std::ifstream& file_;
    const PointsLine& reader_;
    std::vector<char> buffer_ = std::vector<char>(1U << 16U);
    std::string_view text_;
    std::int64_t number_ = 0;
    std::int64_t offset_ = 0;
    std::int64_t next_offset_ = 0;
};

template <class T, class IsMissing>
void drop_if_all(std::vector<T>& column, IsMissing is_missing) {
    if (std::ranges::all_of(column, is_missing)) column.clear();
}

void drop_columns_without_values(Snapshot& snapshot) {
    const auto is_nan = [](double value) { return std::isnan(value); };
    drop_if_all(snapshot.id, [](std::int64_t id) { return id < 0; });
    drop_if_all(snapshot.z, is_nan);
    drop_if_all(snapshot.z_error, is_nan);
    drop_if_all(snapshot.quality, is_nan);
    drop_if_all(snapshot.position_error,
                [](Vec2 error) { return std::isnan(error.x) && std::isnan(error.y); });
    drop_if_all(snapshot.layer, [](Layer layer) { return layer == Layer::unknown; });
}

// What the comments before the header line say.
PointsStatementReader reader_before_header(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    PointsStatementReader comments({});
    for (std::string line; std::getline(file, line) && PointsLine::is_blank(line);) {
        comments.take(line);
    }
    return comments;
}

class PointsTable : public SnapshotSource {
 public:
    PointsTable(const std::filesystem::path& path, const std::optional<Box>& box,
                TrajectoryInfo info, FrameColumn frames)
        : info_(std::move(info)), reader_(path, frames), comments_(info_) {
        if (info_.source.empty()) info_.source = path.filename().string();
        std::error_code error;
        if (std::filesystem::is_directory(path, error)) {
            reader_.fail(0, "a folder", "a table of points");
        }
        file_.open(path, std::ios::binary);
        if (!file_) {
            const bool exists = std::filesystem::exists(path, error);
            reader_.fail(0, exists ? "it may not be read" : "no such file");
        }
        take_statement_beside(path);
        index_lines();
        set_box(box);
    }

    const TrajectoryInfo& info() const override { return info_; }
    std::int64_t count() const override { return static_cast<std::int64_t>(frames_.size()); }
    Snapshot read(std::int64_t index) override;

 private:
    void take_statement_beside(const std::filesystem::path& path);
    void index_lines();
    void take_comment(const LineReader& lines);
    void refuse_repeated(std::int64_t frame);
    void require_growing_times() const;
    void set_box(const std::optional<Box>& box);
    Box bounding_box() const;

    TrajectoryInfo info_;
    PointsLine reader_;
    PointsStatementReader comments_;
    bool is_stated_beside_ = false;
    std::ifstream file_;
    std::map<std::int64_t, IndexedFrame> found_;
    std::vector<std::pair<std::int64_t, std::int64_t>> named_;   ///< identities and their lines
    std::vector<std::pair<std::int64_t, IndexedFrame>> frames_;  ///< by index in the source
    Box box_;
    SnapshotCheck check_;
    Vec2 low_{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Vec2 high_{-low_.x, -low_.y};
};

void PointsTable::take_statement_beside(const std::filesystem::path& path) {
    if (reader_before_header(path).is_ours()) return;
    std::ifstream file(statement_path(path), std::ios::binary);
    std::int64_t number = 0;
    for (std::string line; std::getline(file, line);) {
        const std::string wrong = comments_.take(line);
        if (!wrong.empty()) {
            throw InputError(
                {.problem = fmt::format("'{}', line {}", statement_path(path).string(), number + 1),
                 .actual = wrong,
                 .expected = "what grainfield export writes",
                 .suggestion = "remove the file if it does not belong to the table"});
        }
        if (const auto& said = comments_.frame_time()) found_[said->frame].time = said->time;
        ++number;
    }
    is_stated_beside_ = comments_.is_ours();
}

void PointsTable::take_comment(const LineReader& lines) {
    if (is_stated_beside_) return;
    const std::string wrong = comments_.take(lines.text());
    if (!wrong.empty()) reader_.fail(lines.number(), wrong, "what grainfield export writes");
    if (const auto& said = comments_.frame_time()) found_[said->frame].time = said->time;
}

// Of the points gathered since the last call.
void PointsTable::refuse_repeated(std::int64_t frame) {
    auto named = std::exchange(named_, {});
    std::ranges::sort(named);
    const auto same = std::ranges::adjacent_find(
        named, [](const auto& a, const auto& b) { return a.first == b.first; });
    if (same != named.end()) {
        reader_.fail(std::next(same)->second,
                     fmt::format("particle {} stands in frame {} already, in line {}", same->first,
                                 frame, same->second),
                     "each particle once a frame");
    }
}

void PointsTable::set_box(const std::optional<Box>& box) {
    const std::optional<Box>& stated = comments_.statement().box;
    box_ = box ? *box : stated ? *stated : bounding_box();
    if (box && stated) {
        box_.origin = stated->origin;
        box_.boundary = stated->boundary;
        box_.height = stated->height;
    }
}

void PointsTable::index_lines() {
    LineReader lines(file_, reader_);
    bool in_header = true;
    double lowest_layer = std::numeric_limits<double>::infinity();
    double highest_layer = 0;
    std::int64_t last_frame = -1;
    while (lines.next()) {
        if (PointsLine::is_blank(lines.text())) {
            refuse_repeated(last_frame);
            last_frame = -1;  // pieces hold points only
            take_comment(lines);
            continue;
        }
        if (in_header) {
            reader_.read_header(lines.text(), lines.number());
            in_header = false;
            continue;
        }
        const Point point = reader_.read(lines.text(), lines.number());
        IndexedFrame& entry = found_[point.frame];
        if (point.frame != last_frame) {
            throw_if_interrupted("reading");
            refuse_repeated(last_frame);
            entry.pieces.push_back({.offset = lines.offset(), .line = lines.number(), .lines = 0});
        }
        ++entry.pieces.back().lines;
        ++entry.points;
        if (point.particle < 0) {
            ++entry.unnamed;
        } else {
            named_.emplace_back(point.particle, lines.number());
        }
        last_frame = point.frame;
        if (!std::isnan(point.layer)) {
            lowest_layer = std::min(lowest_layer, point.layer);
            highest_layer = std::max(highest_layer, point.layer);
        }
        low_ = {std::min(low_.x, point.position.x), std::min(low_.y, point.position.y)};
        high_ = {std::max(high_.x, point.position.x), std::max(high_.y, point.position.y)};
    }
    refuse_repeated(last_frame);
    const std::string source = info_.source;
    info_ = comments_.statement().info;
    info_.source = source;
    if (const auto unit = reader_.length_unit()) info_.length_unit = *unit;
    if (lowest_layer == 1 && highest_layer == 2) reader_.number_layers_from(1);
    if (file_.bad()) reader_.fail(0, "reading stopped in the middle");
    if (in_header) {
        reader_.fail(0, "the file is empty", "a header line and one line per point");
    }
    for (const auto& [frame, entry] : found_) {
        if (entry.unnamed == 0 || entry.unnamed == entry.points) continue;
        reader_.fail(0,
                     fmt::format("frame {} has {} of {} points without a particle number", frame,
                                 entry.unnamed, entry.points),
                     "a number for each or for none");
    }
    require_growing_times();
    frames_.assign(std::make_move_iterator(found_.begin()), std::make_move_iterator(found_.end()));
    found_.clear();
}

// Where comments say the times; those of the tracker may be as its camera gave them.
void PointsTable::require_growing_times() const {
    if (info_.origin == Origin::video) return;
    std::optional<double> last;
    for (const auto& [frame, entry] : found_) {
        if (!entry.time) continue;
        if (last && !(*entry.time > *last)) {
            reader_.fail(0,
                         fmt::format("frame {} is at {:.17g}, the one before it at {:.17g}", frame,
                                     *entry.time, *last),
                         "times that grow from frame to frame");
        }
        last = entry.time;
    }
}

Box PointsTable::bounding_box() const {
    if (!(low_.x <= high_.x)) return {.origin = {0, 0}, .length = {info_.diameter, info_.diameter}};
    // Points on one line still need a cell with an area.
    const Vec2 length = high_ - low_;
    return {.origin = low_,
            .length = {length.x > 0 ? length.x : info_.diameter,
                       length.y > 0 ? length.y : info_.diameter}};
}

Snapshot PointsTable::read(std::int64_t index) {
    if (index < 0 || index >= count()) {
        throw OptionError({.problem = fmt::format("'{}' has no entry {}", info_.source, index),
                           .actual = {},
                           .expected = fmt::format("0 … {}", count() - 1),
                           .suggestion = {}});
    }
    const auto& [frame, entry] = frames_[static_cast<std::size_t>(index)];
    Snapshot snapshot;
    snapshot.frame = frame;
    snapshot.time = entry.time.value_or(static_cast<double>(frame) / info_.frame_rate.value_or(1));
    snapshot.box = box_;
    LineReader lines(file_, reader_);
    for (const Piece& piece : entry.pieces) {
        lines.jump(piece.offset, piece.line);
        for (std::int64_t i = 0; i < piece.lines; ++i) {
            if (!lines.next()) reader_.fail(0, "the file has become shorter since it was opened");
            const Point point = reader_.read(lines.text(), lines.number());
            if (point.frame != frame) {
                reader_.fail(lines.number(), "the file has changed since it was opened");
            }
            reader_.append(point, snapshot);
            if (point.particle >= 0 && entry.pieces.size() > 1) {
                named_.emplace_back(point.particle, lines.number());
            }
        }
    }
    refuse_repeated(frame);
    drop_columns_without_values(snapshot);
    if (const auto flaw = check_.flaw_of(snapshot)) {
        reader_.fail(entry.pieces.empty() ? 0 : line_of(entry, flaw->particle),
                     fmt::format("frame {}, {}: {}", frame, particle_name(snapshot, flaw->particle),
                                 flaw->actual),
                     flaw->expected);
    }
    return snapshot;
}

PointsStatement statement_of(const std::filesystem::path& path) {
    PointsStatementReader reader = reader_before_header(path);
    if (reader.is_ours()) return reader.statement();
    std::ifstream beside(statement_path(path), std::ios::binary);
    for (std::string line; std::getline(beside, line);) reader.take(line);
    return reader.statement();
}

}  // namespace

bool states_diameter(const std::filesystem::path& path) {
    return statement_of(path).has_diameter;
}

bool states_box(const std::filesystem::path& path) {
    return statement_of(path).box.has_value();
}

std::unique_ptr<SnapshotSource> open_points(const std::filesystem::path& path,
                                            const std::optional<Box>& box,
                                            const TrajectoryInfo& hints, FrameColumn frames) {
    if (box) require_valid(*box);
    return std::make_unique<PointsTable>(path, box, hints, frames);
}

}  // namespace grainfield::io
