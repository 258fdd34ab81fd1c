#include "io/input_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, std::string actual,
                         std::string expected, std::string suggestion) {
    throw InputError({.problem = fmt::format("cannot read '{}'", path.string()),
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = std::move(suggestion)});
}

std::ifstream open_input(const std::filesystem::path& path) {
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse(path, std::strerror(errno), {}, "check the name and the permissions");
    return file;
}

}  // namespace

void require_file_exists(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) {
        refuse(path, "no such file", "an existing file", "check the name and the folder");
    }
}

void require_input_file(const std::filesystem::path& path) {
    require_file_exists(path);
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (error) refuse(path, error.message(), {}, "check the name and the permissions");
    if (status.type() == std::filesystem::file_type::directory) {
        refuse(path, "it is a folder", "files",
               fmt::format("give the files, e.g. {}/*.tif", path.string()));
    }
    if (status.type() != std::filesystem::file_type::regular) {
        refuse(path, "it is a pipe or a device", "a regular file", "save the data to a file first");
    }
    const auto bytes = std::filesystem::file_size(path, error);
    if (error) refuse(path, error.message(), {}, "check the permissions");
    if (bytes == 0) {
        refuse(path, "the file is empty (0 bytes)", "image or video data",
               "copy the file again from where it was recorded");
    }
}

std::string read_head(const std::filesystem::path& path, std::size_t limit) {
    std::ifstream file = open_input(path);
    std::string head(limit, '\0');
    file.read(head.data(), static_cast<std::streamsize>(limit));
    if (file.bad()) refuse(path, std::strerror(errno), {}, "check the disk");
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head;
}

std::string read_content(const std::filesystem::path& path, std::size_t limit) {
    std::ifstream file = open_input(path);
    std::error_code error;
    const auto bytes = std::filesystem::file_size(path, error);
    if (error) refuse(path, error.message(), {}, "check the permissions");
    if (bytes > limit) {
        refuse(path, fmt::format("{} bytes", bytes), fmt::format("at most {} bytes", limit),
               "raise option 'max-pixels' if the file is really meant");
    }
    std::string content(static_cast<std::size_t>(bytes), '\0');
    file.read(content.data(), static_cast<std::streamsize>(bytes));
    if (file.bad()) refuse(path, std::strerror(errno), {}, "check the disk");
    content.resize(static_cast<std::size_t>(file.gcount()));
    return content;
}

std::string printable(std::string_view bytes) {
    std::string text;
    for (const char c : bytes.substr(0, 16)) {
        const bool plain = c >= 0x20 && c < 0x7f && c != '\\';
        text +=
            plain ? std::string(1, c)
                  : fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
    return text;
}

}  // namespace grainfield::io
