#include "io/text/export_files.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/text/number_text.h"
#include "io/text/points_statement.h"
#include "io/text/text_output.h"

namespace grainfield::io {

namespace {

constexpr const char* units_file = "units.csv";

// The columns that at least one frame has.
struct Columns {
    bool id = false;
    bool z = false;
    bool position_error = false;
    bool z_error = false;
    bool layer = false;
    bool quality = false;
    bool velocity = false;
};

bool is_same(const Box& a, const Box& b) {
    return a.origin == b.origin && a.length == b.length && a.boundary == b.boundary &&
           a.height == b.height;
}

// What the columns cannot say; io/text/points_statement.h reads it back.
PointsStatement statement_of(SnapshotSource& source) {
    PointsStatement statement{.info = source.info(), .box = std::nullopt};
    for (std::int64_t i = 0; i < source.count(); ++i) {
        throw_if_interrupted("export");
        const Box box = source.read(i).box;
        if (statement.box && !is_same(*statement.box, box)) {
            statement.box.reset();
            break;
        }
        statement.box = box;
    }
    return statement;
}

Columns columns_of(SnapshotSource& source) {
    Columns columns;
    for (std::int64_t i = 0; i < source.count(); ++i) {
        throw_if_interrupted("export");
        const Snapshot s = source.read(i);
        columns.id |= !s.id.empty();
        columns.z |= !s.z.empty();
        columns.position_error |= !s.position_error.empty();
        columns.z_error |= !s.z_error.empty();
        columns.layer |= !s.layer.empty();
        columns.quality |= !s.quality.empty();
        columns.velocity |= !s.velocity.empty();
    }
    return columns;
}

/// Numbers of one form.
class NumberWriter {
 public:
    explicit NumberWriter(Digits digits) : is_rounded_(digits == Digits::as_errors) {}

    /// A measured value; nothing for NaN.
    void append_value(std::string& text, double value, double error) const {
        const double decimals = std::max(0.0, std::ceil(1 - std::log10(error)));
        const bool is_usable = error > 0 && std::isfinite(value) && decimals <= most_decimals;
        if (is_rounded_ && is_usable) {
            fmt::format_to(std::back_inserter(text), "{:.{}f}", value, static_cast<int>(decimals));
        } else {
            append_number(text, value);
        }
    }

    /// A number that needs no more than `digits`; nothing for NaN.
    void append_estimate(std::string& text, double value, int digits) const {
        if (is_rounded_ && std::isfinite(value)) {
            fmt::format_to(std::back_inserter(text), "{:.{}g}", value, digits);
        } else {
            append_number(text, value);
        }
    }

 private:
    static constexpr double most_decimals = 15;
    bool is_rounded_;
};

constexpr int error_digits = 3;
constexpr int quality_digits = 4;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

Vec3 errors_of(const Snapshot& s, std::size_t i) {
    const Vec2 error = s.position_error.empty() ? Vec2{unknown, unknown} : s.position_error[i];
    return {error.x, error.y, s.z_error.empty() ? unknown : s.z_error[i]};
}

void append_csv_line(std::string& text, const Snapshot& s, std::size_t i, const Columns& columns,
                     const NumberWriter& numbers) {
    const Vec3 errors = errors_of(s, i);
    const auto append_value = [&](double value, double error) {
        text += ',';
        numbers.append_value(text, value, error);
    };
    const auto append_estimate = [&](double value, int digits) {
        text += ',';
        numbers.append_estimate(text, value, digits);
    };
    append_number(text, s.frame);
    if (columns.id) {
        text += ',';
        if (!s.id.empty()) append_number(text, s.id[i]);
    }
    append_value(s.position[i].x, errors.x);
    append_value(s.position[i].y, errors.y);
    if (columns.z) append_value(s.z.empty() ? unknown : s.z[i], errors.z);
    if (columns.position_error) {
        append_estimate(errors.x, error_digits);
        append_estimate(errors.y, error_digits);
    }
    if (columns.z_error) append_estimate(errors.z, error_digits);
    if (columns.layer) {
        text += ',';
        const Layer layer = s.layer.empty() ? Layer::unknown : s.layer[i];
        if (layer != Layer::unknown) append_number(text, static_cast<std::int64_t>(layer));
    }
    if (columns.quality) {
        append_estimate(s.quality.empty() ? unknown : s.quality[i], quality_digits);
    }
    text += '\n';
}

// Extended XYZ has no empty fields: a missing number is written as nan.
void append_xyz_number(std::string& text, double value) {
    text += ' ';
    if (std::isnan(value)) text += "nan";
    append_number(text, value);
}

std::string xyz_header(const Snapshot& s, const Columns& columns) {
    const auto flag = [&s](std::size_t axis) {
        return s.box.boundary[axis] == Boundary::periodic ? 'T' : 'F';
    };
    std::string text = fmt::format("{}\nLattice=\"", s.size());
    append_number(text, s.box.length.x);
    text += " 0 0 0 ";
    append_number(text, s.box.length.y);
    text += " 0 0 0 ";
    append_number(text, s.box.height > 0 ? s.box.height : 1.0);
    text += "\" Origin=\"";
    append_number(text, s.box.origin.x);
    append_xyz_number(text, s.box.origin.y);
    text += fmt::format(" 0\" pbc=\"{} {} F\" frame={} Time=", flag(0), flag(1), s.frame);
    append_number(text, s.time);
    text += " Properties=species:S:1:pos:R:3:radius:R:1";
    if (columns.id) text += ":id:I:1";
    if (columns.velocity) text += ":velo:R:3";
    if (columns.position_error || columns.z_error) text += ":position_error:R:3";
    if (columns.layer) text += ":layer:I:1";
    if (columns.quality) text += ":quality:R:1";
    return text + "\n";
}

void append_xyz_line(std::string& text, const Snapshot& s, std::size_t i, const Columns& columns,
                     double radius, const NumberWriter& numbers) {
    const double layer = s.layer.empty() ? -1 : static_cast<double>(s.layer[i]);
    const Vec3 errors = errors_of(s, i);
    const auto append_value = [&](double value, double error) {
        text += ' ';
        if (std::isnan(value)) text += "nan";
        numbers.append_value(text, value, error);
    };
    const auto append_estimate = [&](double value, int digits) {
        text += ' ';
        if (std::isnan(value)) text += "nan";
        numbers.append_estimate(text, value, digits);
    };
    text += 'A';
    append_value(s.position[i].x, errors.x);
    append_value(s.position[i].y, errors.y);
    append_value(s.z.empty() ? std::max(layer, 0.0) : s.z[i], errors.z);
    append_xyz_number(text, radius);
    if (columns.id) text += fmt::format(" {}", s.id.empty() ? -1 : s.id[i]);
    if (columns.velocity) {
        const Vec3 v = s.velocity.empty() ? Vec3{unknown, unknown, unknown} : s.velocity[i];
        append_xyz_number(text, v.x);
        append_xyz_number(text, v.y);
        append_xyz_number(text, v.z);
    }
    if (columns.position_error || columns.z_error) {
        append_estimate(errors.x, error_digits);
        append_estimate(errors.y, error_digits);
        append_estimate(errors.z, error_digits);
    }
    if (columns.layer) append_xyz_number(text, layer);
    if (columns.quality) {
        append_estimate(s.quality.empty() ? unknown : s.quality[i], quality_digits);
    }
    text += '\n';
}

std::string curve_text(const Curve& curve) {
    std::string text;
    const std::size_t first = std::min<std::size_t>(curve.columns.size(), 1);
    std::size_t rows = curve.columns.empty() ? 0 : curve.columns.front().values.size();
    for (const auto& [name, words] : curve.text_columns) rows = std::max(rows, words.size());
    // Line 0 is the header.
    for (std::size_t line = 0; line <= rows; ++line) {
        std::size_t cells = 0;
        const auto append_column = [&](const Column& column) {
            if (cells++ > 0) text += ',';
            if (line == 0) {
                append_field(text, column.name);
            } else {
                append_number(text, column.values.at(line - 1));
            }
        };
        for (std::size_t c = 0; c < first; ++c) append_column(curve.columns[c]);
        for (const auto& [name, words] : curve.text_columns) {
            if (cells++ > 0) text += ',';
            append_field(text, line == 0 ? name : words.at(line - 1));
        }
        for (std::size_t c = first; c < curve.columns.size(); ++c) append_column(curve.columns[c]);
        text += '\n';
    }
    return text;
}

// What the columns of all curves are; the tables themselves stay plain.
std::string units_text(const std::vector<const Curve*>& curves, TimeUnit time_unit) {
    std::string text = "curve,column,unit,meaning\n";
    for (const Curve* curve : curves) {
        for (const Column& column : curve->columns) {
            append_field(text, curve->name);
            for (const std::string& words :
                 {column.name, plain_text(column.unit, time_unit), column.meaning}) {
                text += ',';
                append_field(text, words);
            }
            text += '\n';
        }
    }
    return text;
}

// Curve names come from a file: they must not lead out of the folder.
void require_plain(const std::string& name) {
    const bool is_plain = !name.empty() && std::ranges::all_of(name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_' || c == '-';
    });
    if (is_plain) return;
    throw InputError({.problem = fmt::format("cannot name a file after the curve '{}'", name),
                      .actual = {},
                      .expected = "letters, digits, '_' and '-'",
                      .suggestion = {}});
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (std::filesystem::is_directory(folder)) return;
    throw OutputError({.problem = fmt::format("cannot make the folder '{}'", folder.string()),
                       .actual = error ? error.message() : "a file has this name",
                       .expected = {},
                       .suggestion = "give another name"});
}

}  // namespace

void export_csv(SnapshotSource& source, const std::filesystem::path& path, Overwrite overwrite,
                const PointsForm& form) {
    TextOutput output(path, overwrite);
    std::optional<TextOutput> beside;
    if (!form.header) beside.emplace(statement_path(path), overwrite);
    TextOutput& statement_output = beside ? *beside : output;
    const NumberWriter numbers(form.digits);
    const Columns columns = columns_of(source);
    const PointsStatement statement = statement_of(source);
    statement_output.write(text_of(statement));
    std::string text = "frame";
    if (columns.id) text += ",particle";
    text += ",x,y";
    if (columns.z) text += ",z";
    if (columns.position_error) text += ",x_std,y_std";
    if (columns.z_error) text += ",z_std";
    if (columns.layer) text += ",layer";
    if (columns.quality) text += ",quality";
    output.write(text + '\n');
    for (std::int64_t index = 0; index < source.count(); ++index) {
        throw_if_interrupted("export");
        const Snapshot snapshot = source.read(index);
        statement_output.write(frame_comment(snapshot, statement.info));
        text.clear();
        for (std::size_t i = 0; i < snapshot.size(); ++i) {
            append_csv_line(text, snapshot, i, columns, numbers);
        }
        output.write(text);
    }
    if (beside) beside->commit();
    output.commit();
}

void export_xyz(SnapshotSource& source, const std::filesystem::path& path, Overwrite overwrite,
                Digits digits) {
    TextOutput output(path, overwrite);
    const NumberWriter numbers(digits);
    const Columns columns = columns_of(source);
    const double radius = source.info().diameter / 2;
    for (std::int64_t index = 0; index < source.count(); ++index) {
        throw_if_interrupted("export");
        const Snapshot snapshot = source.read(index);
        std::string text = xyz_header(snapshot, columns);
        for (std::size_t i = 0; i < snapshot.size(); ++i) {
            append_xyz_line(text, snapshot, i, columns, radius, numbers);
        }
        output.write(text);
    }
    output.commit();
}

void export_curves(const Results& results, const std::filesystem::path& folder,
                   Overwrite overwrite) {
    std::vector<const Curve*> curves;
    std::set<std::string> names{"units"};
    for (const ObservableResult& observable : results.observables) {
        for (const Curve& curve : observable.curves) {
            require_plain(curve.name);
            if (!names.insert(curve.name).second) {
                throw InputError(fmt::format("two curves have the name '{}'", curve.name));
            }
            curves.push_back(&curve);
        }
    }
    make_folder(folder);
    std::vector<TextOutput> outputs;
    for (const Curve* curve : curves)
        outputs.emplace_back(folder / (curve->name + ".csv"), overwrite);
    outputs.emplace_back(folder / units_file, overwrite);
    outputs.back().write(units_text(curves, results.source.time_unit));
    for (std::size_t i = 0; i < curves.size(); ++i) outputs[i].write(curve_text(*curves[i]));
    for (TextOutput& output : outputs) output.commit();
}

}  // namespace grainfield::io
