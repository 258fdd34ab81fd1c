#include "io/text/wavevector_csv.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 26;

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

[[noreturn]] void fail(const std::filesystem::path& path, std::int64_t line,
                       const std::string& actual) {
    throw InputError({.problem = fmt::format("cannot read '{}', line {}", path.string(), line),
                      .actual = actual,
                      .expected = "kx,ky in 1/a, two numbers a line",
                      .suggestion = {}});
}

double number(std::string_view text, const std::filesystem::path& path, std::int64_t line,
              std::string_view name) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
        fail(path, line, fmt::format("{} is '{}'", name, printable(text)));
    }
    return value;
}

}  // namespace

std::vector<Vec2> read_wavevectors(const std::filesystem::path& path) {
    require_input_file(path);
    const std::string content = read_content(path, most_bytes);
    std::string_view rest = content;
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (rest.starts_with(byte_order_mark)) rest.remove_prefix(byte_order_mark.size());
    std::vector<Vec2> wavevectors;
    bool is_first = true;
    for (std::int64_t line = 1; !rest.empty(); ++line) {
        const std::size_t end = rest.find('\n');
        const std::string_view text = trimmed(rest.substr(0, end));
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
        if (text.empty() || text.front() == '#') continue;
        const std::size_t comma = text.find(',');
        if (comma == std::string_view::npos ||
            text.find(',', comma + 1) != std::string_view::npos) {
            fail(path, line, fmt::format("'{}'", printable(text)));
        }
        const std::array<std::string_view, 2> field{trimmed(text.substr(0, comma)),
                                                    trimmed(text.substr(comma + 1))};
        const bool is_header = is_first && field[0] == "kx" && field[1] == "ky";
        is_first = false;
        if (is_header) continue;
        const Vec2 k{number(field[0], path, line, "kx"), number(field[1], path, line, "ky")};
        if (k.x == 0 && k.y == 0) {
            fail(path, line, "kx = ky = 0, which gives the number of particles and no S(k)");
        }
        wavevectors.push_back(k);
    }
    if (wavevectors.empty()) {
        throw InputError({.problem = fmt::format("'{}' lists no wavevectors", path.string()),
                          .actual = {},
                          .expected = "kx,ky in 1/a, two numbers a line",
                          .suggestion = {}});
    }
    return wavevectors;
}

}  // namespace grainfield::io
