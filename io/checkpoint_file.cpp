#include "io/checkpoint_file.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

#include "core/errors.h"
#include "io/output_file.h"

namespace grainfield::io {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view magic = "grainfield checkpoint 1\n";

std::uint32_t checksum(std::string_view bytes) {
    uLong crc = ::crc32(0, nullptr, 0);
    constexpr std::size_t step = std::size_t{1} << 30;
    for (std::size_t at = 0; at < bytes.size(); at += step) {
        const std::string_view part = bytes.substr(at, step);
        crc = ::crc32(crc, reinterpret_cast<const Bytef*>(part.data()),
                      static_cast<uInt>(part.size()));
    }
    return static_cast<std::uint32_t>(crc);
}

void append_raw(std::string& bytes, const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
}

void append_count(std::string& bytes, std::size_t count) {
    const std::uint64_t value = count;
    append_raw(bytes, &value, sizeof(value));
}

void append_text(std::string& bytes, const std::string& text) {
    append_count(bytes, text.size());
    bytes += text;
}

template <class T>
void append_columns(std::string& bytes, const std::map<std::string, std::vector<T>>& columns) {
    append_count(bytes, columns.size());
    for (const auto& [name, values] : columns) {
        append_text(bytes, name);
        append_count(bytes, values.size());
        append_raw(bytes, values.data(), values.size() * sizeof(T));
    }
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
    throw InputError({.problem = fmt::format("cannot go on from '{}'", path.string()),
                      .actual = what,
                      .expected = "a checkpoint of this version",
                      .suggestion = "start the run anew without --resume"});
}

class Reader {
 public:
    Reader(std::string_view bytes, const std::filesystem::path& path) : rest_(bytes), path_(path) {}

    std::string_view take(std::uint64_t size) {
        if (size > rest_.size()) refuse(path_, "it ends too early");
        const std::string_view part = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return part;
    }
    std::uint64_t count() {
        std::uint64_t value = 0;
        std::memcpy(&value, take(sizeof(value)).data(), sizeof(value));
        return value;
    }
    std::string text() { return std::string(take(count())); }

    template <class T>
    std::map<std::string, std::vector<T>> columns() {
        std::map<std::string, std::vector<T>> columns;
        for (std::uint64_t left = count(); left > 0; --left) {
            std::string name = text();
            const std::uint64_t size = count();
            if (size > rest_.size() / sizeof(T)) refuse(path_, "it ends too early");
            std::vector<T> values(size);
            const std::string_view part = take(size * sizeof(T));
            if (size > 0) std::memcpy(values.data(), part.data(), part.size());
            columns.emplace(std::move(name), std::move(values));
        }
        return columns;
    }

 private:
    std::string_view rest_;
    const std::filesystem::path& path_;
};

}  // namespace

void write_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& path) {
    std::string bytes(magic);
    append_text(bytes, checkpoint.kind);
    append_count(bytes, checkpoint.configuration.size());
    for (const auto& [name, value] : checkpoint.configuration) {
        append_text(bytes, name);
        append_text(bytes, value);
    }
    append_columns(bytes, checkpoint.reals);
    append_columns(bytes, checkpoint.integers);
    const std::uint32_t crc = checksum(bytes);
    append_raw(bytes, &crc, sizeof(crc));

    OutputFile output(path, Overwrite::force);
    std::ofstream file(output.temporary(), std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
        throw OutputError({.problem = fmt::format("cannot write '{}'", path.string()),
                           .actual = {},
                           .expected = {},
                           .suggestion = "check the free space and quota of that disk"});
    }
    output.commit();
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse(path, "it cannot be read");
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::string_view content = bytes;
    if (!content.starts_with(magic)) refuse(path, "it is something else");
    std::uint32_t crc = 0;
    if (content.size() < magic.size() + sizeof(crc)) refuse(path, "it ends too early");
    std::memcpy(&crc, content.data() + content.size() - sizeof(crc), sizeof(crc));
    content.remove_suffix(sizeof(crc));
    if (crc != checksum(content)) refuse(path, "its checksum is wrong: it is damaged");
    Reader reader(content.substr(magic.size()), path);
    Checkpoint checkpoint;
    checkpoint.kind = reader.text();
    for (std::uint64_t left = reader.count(); left > 0; --left) {
        std::string name = reader.text();
        std::string value = reader.text();
        checkpoint.configuration.emplace_back(std::move(name), std::move(value));
    }
    checkpoint.reals = reader.columns<double>();
    checkpoint.integers = reader.columns<std::int64_t>();
    return checkpoint;
}

void require_same_configuration(
    const Checkpoint& checkpoint,
    const std::vector<std::pair<std::string, std::string>>& configuration,
    const std::filesystem::path& path) {
    const std::map<std::string, std::string> before(checkpoint.configuration.begin(),
                                                    checkpoint.configuration.end());
    const std::map<std::string, std::string> now(configuration.begin(), configuration.end());
    std::string difference;
    const auto differ = [&difference](const std::string& name, const std::string& old_value,
                                      const std::string& new_value) {
        difference += fmt::format("{}{} was {}, is {}", difference.empty() ? "" : "; ", name,
                                  old_value, new_value);
    };
    for (const auto& [name, value] : before) {
        const auto found = now.find(name);
        if (found == now.end()) {
            differ(name, value, "absent");
        } else if (found->second != value) {
            differ(name, value, found->second);
        }
    }
    for (const auto& [name, value] : now) {
        if (!before.contains(name)) differ(name, "absent", value);
    }
    if (difference.empty()) return;
    throw OptionError(
        {.problem = fmt::format("'{}' belongs to a run with other options", path.string()),
         .actual = difference,
         .expected = {},
         .suggestion = "give the same options, or start anew without --resume"});
}

}  // namespace grainfield::io
