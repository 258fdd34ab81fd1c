#include "io/input_record.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "core/errors.h"
#include "core/support/interrupt.h"

namespace grainfield::io {

namespace {

/// An interrupted run ends at once: its inputs can wait, a long video as well as thousands of
/// pictures that would be opened one after the other.
RunRecord::Input not_read(const std::filesystem::path& path) {
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(path, unknown);
    return {path.string(), unknown ? 0 : bytes, "not computed, the run was interrupted"};
}

}  // namespace

RunRecord::Input describe_input(const std::filesystem::path& path) {
    if (caught_signal() != 0) return not_read(path);
    const auto refuse = [&path] {
        throw InputError({.problem = fmt::format("cannot read '{}'", path.string()),
                          .actual = std::strerror(errno),
                          .expected = "a readable file",
                          .suggestion = "check the name and the permissions"});
    };
    RunRecord::Input record;
    record.name = path.string();
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse();

    std::vector<char> piece(1U << 20U);
    uLong checksum = crc32(0, nullptr, 0);
    while (file) {
        if (caught_signal() != 0) return not_read(path);
        file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
        const auto got = static_cast<std::size_t>(file.gcount());
        checksum =
            crc32(checksum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(got));
        record.bytes += got;
    }
    // A folder opens as a file and fails on the first read.
    if (file.bad() || !file.eof()) refuse();
    record.checksum = fmt::format("crc32:{:08x}", checksum);
    return record;
}

}  // namespace grainfield::io
