#include "io/h5/checkpoint_file.h"

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "core/errors.h"
#include "core/support/output_file.h"
#include "io/h5/detail/run_record_json.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "files are little-endian");

constexpr std::string_view signature("grainfield checkpoint\0", 22);
constexpr std::uint32_t format_version = 1;

/// A file, and what it is read for.
struct Source {
    const fs::path& path;
    CheckpointUse use;
};

[[noreturn]] void refuse(const Source& source, const std::string& actual,
                         const std::string& expected = {}) {
    const bool goes_on = source.use == CheckpointUse::resume;
    throw InputError({.problem = fmt::format("cannot {} '{}'", goes_on ? "go on from" : "merge",
                                             source.path.string()),
                      .actual = actual,
                      .expected = expected,
                      .suggestion = goes_on ? "start again without option 'resume'"
                                            : "measure that part again with option 'partial'"});
}

std::uint32_t checksum(std::string_view bytes) {
    uLong sum = crc32(0, nullptr, 0);
    while (!bytes.empty()) {
        const std::string_view piece = bytes.substr(0, 1U << 30U);
        sum = crc32(sum, reinterpret_cast<const Bytef*>(piece.data()),
                    static_cast<uInt>(piece.size()));
        bytes.remove_prefix(piece.size());
    }
    return static_cast<std::uint32_t>(sum);
}

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <class Arrays>
json lengths(const Arrays& arrays) {
    json list = json::array();
    for (const auto& [name, values] : arrays) list.push_back({name, values.size()});
    return list;
}

std::string serialised(const Checkpoint& checkpoint) {
    json configuration = json::array();
    for (const auto& [name, value] : checkpoint.configuration) {
        configuration.push_back({name, value});
    }
    const std::string header = json{{"kind", checkpoint.kind},
                                    {"configuration", configuration},
                                    {"texts", checkpoint.texts},
                                    {"reals", lengths(checkpoint.reals)},
                                    {"integers", lengths(checkpoint.integers)}}
                                   .dump(-1, ' ', false, json::error_handler_t::replace);
    std::string bytes(signature);
    append(bytes, &format_version, 1);
    const std::uint64_t header_bytes = header.size();
    append(bytes, &header_bytes, 1);
    bytes += header;
    for (const auto& [name, values] : checkpoint.reals) append(bytes, values.data(), values.size());
    for (const auto& [name, values] : checkpoint.integers) {
        append(bytes, values.data(), values.size());
    }
    const std::uint32_t sum = checksum(bytes);
    append(bytes, &sum, 1);
    return bytes;
}

/// Takes values off the front of a file's content.
class Reader {
 public:
    Reader(std::string_view rest, const Source& source) : rest_(rest), source_(source) {}

    std::string_view take(std::uint64_t bytes) {
        if (bytes > rest_.size()) refuse(source_, "the header promises more than the file holds");
        const std::string_view piece = rest_.substr(0, bytes);
        rest_.remove_prefix(bytes);
        return piece;
    }
    template <class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
        return value;
    }
    template <class T>
    void arrays(const json& list, std::map<std::string, std::vector<T>>& to) {
        for (const json& entry : list) {
            const auto count = whole_from_json<std::uint64_t>(entry.at(1));
            if (count > rest_.size() / sizeof(T)) {
                refuse(source_, "the header promises more than the file holds");
            }
            std::vector<T>& values = to[entry.at(0).get<std::string>()];
            values.resize(count);
            if (count > 0)
                std::memcpy(values.data(), take(count * sizeof(T)).data(), count * sizeof(T));
        }
    }
    bool is_empty() const { return rest_.empty(); }

 private:
    std::string_view rest_;
    const Source& source_;
};

std::string content(const Source& source) {
    errno = 0;
    std::ifstream file(source.path, std::ios::binary);
    std::string bytes;
    std::vector<char> piece(1U << 20U);
    while (file) {
        file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
        bytes.append(piece.data(), static_cast<std::size_t>(file.gcount()));
    }
    // A folder opens as a file and fails on the first read.
    if (file.bad() || !file.eof()) {
        refuse(source, errno == 0 ? "it cannot be read" : std::strerror(errno),
               source.use == CheckpointUse::resume ? "the checkpoint of an interrupted run"
                                                   : "a part of an analysis");
    }
    return bytes;
}

Checkpoint parsed(Reader reader, const Source& source) {
    Checkpoint checkpoint;
    try {
        const json header = json::parse(reader.take(reader.number<std::uint64_t>()));
        checkpoint.kind = header.at("kind").get<std::string>();
        for (const json& entry : header.at("configuration")) {
            checkpoint.configuration.emplace_back(entry.at(0).get<std::string>(),
                                                  entry.at(1).get<std::string>());
        }
        // Files of version 1 that were written before texts existed have none.
        if (header.contains("texts")) header.at("texts").get_to(checkpoint.texts);
        reader.arrays(header.at("reals"), checkpoint.reals);
        reader.arrays(header.at("integers"), checkpoint.integers);
    } catch (const json::exception& error) {
        refuse(source, fmt::format("its header is damaged ({})", error.what()));
    }
    if (!reader.is_empty()) refuse(source, "there is more in it than its header says");
    return checkpoint;
}

}  // namespace

void write_checkpoint(const Checkpoint& checkpoint, const fs::path& path) {
    const std::string bytes = serialised(checkpoint);
    OutputFile output(path, Overwrite::force);
    errno = 0;
    std::ofstream file(output.temporary(), std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
        throw OutputError(
            {.problem = fmt::format("cannot write '{}'", path.string()),
             .actual = errno == 0 ? "the write failed" : std::generic_category().message(errno),
             .expected = {},
             .suggestion = "check the free space and quota of that disk"});
    }
    output.commit();
}

Checkpoint read_checkpoint(const fs::path& path, CheckpointUse use) {
    const Source source{path, use};
    const std::string bytes = content(source);
    const std::string_view all(bytes);
    if (!all.starts_with(signature)) {
        if (use == CheckpointUse::merge) {
            refuse(source, "it is no part of an analysis",
                   "the output of 'grainfield analyze --partial'");
        }
        refuse(source, "it is not a checkpoint",
               "a file that an interrupted run of grainfield left behind");
    }
    Reader start(all.substr(signature.size()), source);
    if (const auto version = start.number<std::uint32_t>(); version != format_version) {
        refuse(source, fmt::format("format version {}", version),
               fmt::format("version {}", format_version));
    }
    constexpr std::size_t before = signature.size() + sizeof(std::uint32_t);
    constexpr std::size_t after = sizeof(std::uint32_t);
    if (all.size() < before + after) refuse(source, "it is cut short");
    const std::string_view checked = all.substr(0, all.size() - after);
    if (Reader(all.substr(checked.size()), source).number<std::uint32_t>() != checksum(checked)) {
        refuse(source, "it is damaged: the checksum does not fit");
    }
    return parsed(Reader(checked.substr(before), source), source);
}

void require_same_configuration(
    const Checkpoint& checkpoint,
    const std::vector<std::pair<std::string, std::string>>& configuration, const fs::path& path,
    CheckpointUse use) {
    const bool goes_on = use == CheckpointUse::resume;
    const std::map<std::string, std::string> then(checkpoint.configuration.begin(),
                                                  checkpoint.configuration.end());
    const std::map<std::string, std::string> now(configuration.begin(), configuration.end());
    std::string differences;
    const auto note = [&](const std::string& name, const std::string& before,
                          const std::string& after) {
        differences += fmt::format("{}{}: {} in the {}, {} now", differences.empty() ? "" : "; ",
                                   name, before, goes_on ? "checkpoint" : "part", after);
    };
    for (const auto& [name, value] : then) {
        const auto other = now.find(name);
        if (other == now.end()) note(name, value, "absent");
        if (other != now.end() && other->second != value) note(name, value, other->second);
    }
    for (const auto& [name, value] : now) {
        if (!then.contains(name)) note(name, "absent", value);
    }
    if (differences.empty()) return;
    if (!goes_on) {
        throw InputError(
            {.problem = fmt::format("'{}' was measured with other options", path.string()),
             .actual = differences,
             .expected = "the same options for all parts and for their merging",
             .suggestion = "give the options that the parts were measured with, or measure all "
                           "parts again with these"});
    }
    throw InputError({.problem = fmt::format("'{}' is of a run with other options", path.string()),
                      .actual = differences,
                      .expected = {},
                      .suggestion =
                          "resume with the options of the checkpoint, or start anew under "
                          "another name"});
}

}  // namespace grainfield::io
