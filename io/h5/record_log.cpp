#include "io/h5/record_log.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include "core/errors.h"

namespace grainfield::io {

namespace {

std::uint32_t checksum(const char* bytes, std::size_t count) {
    uLong sum = crc32(0, nullptr, 0);
    while (count > 0) {
        const std::size_t piece = std::min<std::size_t>(count, 1U << 30U);
        sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes), static_cast<uInt>(piece));
        bytes += piece;
        count -= piece;
    }
    return static_cast<std::uint32_t>(sum);
}

[[noreturn]] void fail_writing(const std::filesystem::path& path) {
    const bool is_link = errno == ELOOP;
    throw OutputError({.problem = fmt::format("cannot write '{}'", path.string()),
                       .actual = is_link ? "a symbolic link stands in its place"
                                         : std::generic_category().message(errno),
                       .expected = {},
                       .suggestion = is_link ? "remove the link, or give the output another name"
                                             : "check the free space and quota of that disk"});
}

void put(int descriptor, const void* data, std::size_t count, const std::filesystem::path& path) {
    const char* next = static_cast<const char*>(data);
    while (count > 0) {
        const ssize_t done = ::write(descriptor, next, count);
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) fail_writing(path);
        next += done;
        count -= static_cast<std::size_t>(done);
    }
}

}  // namespace

RecordLog::RecordLog(std::filesystem::path path, std::int64_t bytes)
    : path_(std::move(path)), bytes_(bytes) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) fail_writing(path_);
    const off_t there = ::lseek(descriptor_, 0, SEEK_END);
    if (there < bytes_) {
        ::close(descriptor_);
        fail_reading("it is shorter than the checkpoint says");
    }
    if (::ftruncate(descriptor_, bytes_) != 0 || ::lseek(descriptor_, bytes_, SEEK_SET) < 0) {
        ::close(descriptor_);
        fail_writing(path_);
    }
    begun_ = bytes_;
    try {
        find_records();
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

RecordLog::~RecordLog() {
    ::close(descriptor_);
}

void RecordLog::fail_reading(const char* what) const {
    throw InputError({.problem = fmt::format("cannot go on from '{}'", path_.string()),
                      .actual = what,
                      .expected = {},
                      .suggestion = "start the run anew"});
}

std::vector<char> RecordLog::bytes_at(std::int64_t start, std::size_t count) const {
    std::vector<char> bytes(count);
    std::size_t done = 0;
    while (done < count) {
        const ssize_t got = ::pread(descriptor_, bytes.data() + done, count - done,
                                    start + static_cast<std::int64_t>(done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) fail_reading("it is cut short");
        done += static_cast<std::size_t>(got);
    }
    return bytes;
}

void RecordLog::find_records() {
    std::int64_t at = 0;
    while (at < bytes_) {
        std::uint64_t length = 0;
        if (bytes_ - at < static_cast<std::int64_t>(sizeof(length))) fail_reading("it is damaged");
        std::memcpy(&length, bytes_at(at, sizeof(length)).data(), sizeof(length));
        const auto left = static_cast<std::uint64_t>(bytes_ - at) - sizeof(length);
        if (left < sizeof(std::uint32_t) || length > left - sizeof(std::uint32_t)) {
            fail_reading("it is damaged");
        }
        starts_.push_back(at);
        at += static_cast<std::int64_t>(sizeof(length) + length + sizeof(std::uint32_t));
    }
}

void RecordLog::append(const std::vector<double>& numbers) {
    const std::uint64_t length = numbers.size() * sizeof(double);
    const std::uint32_t sum = checksum(reinterpret_cast<const char*>(numbers.data()), length);
    put(descriptor_, &length, sizeof(length), path_);
    put(descriptor_, numbers.data(), length, path_);
    put(descriptor_, &sum, sizeof(sum), path_);
    starts_.push_back(bytes_);
    bytes_ += static_cast<std::int64_t>(sizeof(length) + length + sizeof(sum));
    begin_sync();
}

/// What was written since the last time goes on its way to the disk, so that sync() has little left
/// to wait for. Where it cannot be asked for, sync() does it all.
void RecordLog::begin_sync() {
#if defined(__linux__)
    constexpr std::int64_t kPiece = std::int64_t{1} << 23;  // [byte]
    if (bytes_ - begun_ < kPiece) return;
    ::sync_file_range(descriptor_, begun_, bytes_ - begun_, SYNC_FILE_RANGE_WRITE);
    begun_ = bytes_;
#endif
}

void RecordLog::sync() {
    if (::fsync(descriptor_) != 0) fail_writing(path_);
}

void RecordLog::remove() {
    ::unlink(path_.c_str());
}

std::vector<double> RecordLog::read(std::int64_t index) const {
    const std::int64_t start = starts_.at(static_cast<std::size_t>(index));
    std::uint64_t length = 0;
    std::memcpy(&length, bytes_at(start, sizeof(length)).data(), sizeof(length));
    const std::vector<char> bytes =
        bytes_at(start + static_cast<std::int64_t>(sizeof(length)), length + sizeof(std::uint32_t));
    std::uint32_t sum = 0;
    std::memcpy(&sum, bytes.data() + length, sizeof(sum));
    if (sum != checksum(bytes.data(), length)) fail_reading("a record in it is damaged");
    std::vector<double> numbers(length / sizeof(double));
    if (!numbers.empty()) {
        std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
    }
    return numbers;
}

}  // namespace grainfield::io
