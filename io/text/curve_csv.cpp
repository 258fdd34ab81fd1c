#include "io/text/curve_csv.h"

#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 26;

std::vector<std::string_view> fields_of(std::string_view line) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::vector<std::string_view> fields;
    for (;;) {
        const std::size_t comma = line.find(',');
        fields.push_back(line.substr(0, comma));
        if (comma == std::string_view::npos) return fields;
        line.remove_prefix(comma + 1);
    }
}

// NaN for nothing; no value for words.
std::optional<double> number(std::string_view text) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (text.empty()) return value;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

void add_column(Curve& curve, const std::vector<std::vector<std::string_view>>& rows,
                std::size_t at) {
    const std::string name(rows.front()[at]);
    Column column{name, "", name, {}};
    for (std::size_t r = 1; r < rows.size(); ++r) {
        const std::optional<double> value = number(rows[r][at]);
        if (!value) break;
        column.values.push_back(*value);
    }
    if (column.values.size() + 1 == rows.size()) {
        curve.columns.push_back(std::move(column));
        return;
    }
    std::vector<std::string> words;
    for (std::size_t r = 1; r < rows.size(); ++r) words.emplace_back(rows[r][at]);
    curve.text_columns.emplace(name, std::move(words));
}

}  // namespace

Curve read_curve_csv(const std::filesystem::path& path) {
    require_input_file(path);
    const std::string content = read_content(path, most_bytes);
    std::vector<std::vector<std::string_view>> rows;
    std::string_view rest = content;
    for (std::int64_t line = 1; !rest.empty(); ++line) {
        const std::size_t end = rest.find('\n');
        std::vector<std::string_view> fields = fields_of(rest.substr(0, end));
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
        if (!rows.empty() && fields.size() != rows.front().size()) {
            throw InputError(
                {.problem = fmt::format("cannot read '{}', line {}", path.string(), line),
                 .actual = fmt::format("{} fields", fields.size()),
                 .expected = fmt::format("{}, as in the header", rows.front().size()),
                 .suggestion = {}});
        }
        rows.push_back(std::move(fields));
    }
    if (rows.empty()) {
        throw InputError({.problem = fmt::format("cannot read '{}'", path.string()),
                          .actual = "the file is empty",
                          .expected = "a header line and numbers",
                          .suggestion = {}});
    }
    Curve curve{path.stem().string(), "", {}, {}};
    for (std::size_t c = 0; c < rows.front().size(); ++c) add_column(curve, rows, c);
    return curve;
}

}  // namespace grainfield::io
