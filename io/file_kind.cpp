#include "io/file_kind.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/h5/detail/h5_group.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

[[noreturn]] void fail(const fs::path& path, const char* actual) {
    throw InputError({.problem = fmt::format("cannot read '{}'", path.string()),
                      .actual = actual,
                      .expected = {},
                      .suggestion = {}});
}

FileKind identify_hdf5(const fs::path& path) {
    const H5File file = H5File::open(path);
    const H5Group root = H5Group::root(file);
    if (root.has("results")) return FileKind::results;
    if (root.has("h5md")) return FileKind::trajectory;
    if (root.has("field")) return FileKind::field;
    return FileKind::unknown;
}

// A first line of text with the words x and y between commas.
bool has_points_header(std::string_view head) {
    if (head.find('\0') != std::string_view::npos) return false;
    std::string line;
    for (std::size_t begin = 0; begin < head.size();) {
        const std::size_t end = std::min(head.find('\n', begin), head.size());
        line = head.substr(begin, end - begin);
        begin = end + 1;
        std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; });
        if (!line.empty() && line.front() != '#') break;
    }
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    std::ranges::replace(line, 'X', 'x');
    std::ranges::replace(line, 'Y', 'y');
    line = "," + line + ",";
    const auto has = [&line](const char* name) { return line.find(name) != std::string::npos; };
    return (has(",x,") || has(",x_px,")) && (has(",y,") || has(",y_px,"));
}

}  // namespace

FileKind identify(const fs::path& path) {
    std::error_code error;
    if (!fs::exists(path, error)) fail(path, "no such file");
    if (!fs::is_regular_file(path, error)) return FileKind::unknown;
    std::ifstream file(path, std::ios::binary);
    if (!file) fail(path, "it may not be read");
    std::array<char, 4096> buffer{};
    file.read(buffer.data(), buffer.size());
    const std::string_view head(buffer.data(), static_cast<std::size_t>(file.gcount()));
    if (head.starts_with(hdf5_signature)) return identify_hdf5(path);
    return has_points_header(head) ? FileKind::points : FileKind::unknown;
}

}  // namespace grainfield::io
