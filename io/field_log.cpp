#include "io/field_log.h"

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

constexpr std::size_t head_numbers = 8;

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

std::vector<double> flattened(const FieldFrame& frame) {
    const DensityField& first = frame.density.front();
    const bool has_order = !frame.order.value.empty();
    std::vector<double> numbers{static_cast<double>(frame.dimension),
                                static_cast<double>(first.nx),
                                static_cast<double>(first.ny),
                                first.spacing,
                                static_cast<double>(first.step),
                                first.time,
                                static_cast<double>(frame.density.size()),
                                frame.mean_diffusivity};
    numbers.push_back(has_order ? 1 : 0);
    for (const DensityField& field : frame.density) {
        numbers.insert(numbers.end(), field.value.begin(), field.value.end());
    }
    numbers.insert(numbers.end(), frame.order.value.begin(), frame.order.value.end());
    return numbers;
}

[[noreturn]] void fail_writing(const std::filesystem::path& path) {
    throw OutputError({.problem = fmt::format("cannot write '{}'", path.string()),
                       .actual = std::generic_category().message(errno),
                       .expected = {},
                       .suggestion = "check the free space and quota of that disk"});
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

FieldLog::FieldLog(std::filesystem::path path, std::int64_t bytes)
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
    find_records();
}

FieldLog::~FieldLog() {
    ::close(descriptor_);
}

void FieldLog::fail_reading(const char* what) const {
    throw InputError({.problem = fmt::format("cannot go on from '{}'", path_.string()),
                      .actual = what,
                      .expected = {},
                      .suggestion = "start again without --resume"});
}

std::vector<char> FieldLog::bytes_at(std::int64_t start, std::size_t count) const {
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

void FieldLog::find_records() {
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

void FieldLog::write(const FieldFrame& frame) {
    const std::vector<double> numbers = flattened(frame);
    const std::uint64_t length = numbers.size() * sizeof(double);
    const std::uint32_t sum = checksum(reinterpret_cast<const char*>(numbers.data()), length);
    put(descriptor_, &length, sizeof(length), path_);
    put(descriptor_, numbers.data(), length, path_);
    put(descriptor_, &sum, sizeof(sum), path_);
    starts_.push_back(bytes_);
    bytes_ += static_cast<std::int64_t>(sizeof(length) + length + sizeof(sum));
}

void FieldLog::sync() {
    if (::fsync(descriptor_) != 0) fail_writing(path_);
}

void FieldLog::remove() {
    ::unlink(path_.c_str());
}

FieldFrame FieldLog::read(std::int64_t index) {
    const std::int64_t start = starts_.at(static_cast<std::size_t>(index));
    std::uint64_t length = 0;
    std::memcpy(&length, bytes_at(start, sizeof(length)).data(), sizeof(length));
    const std::vector<char> bytes =
        bytes_at(start + static_cast<std::int64_t>(sizeof(length)), length + sizeof(std::uint32_t));
    std::uint32_t sum = 0;
    std::memcpy(&sum, bytes.data() + length, sizeof(sum));
    std::vector<double> numbers(length / sizeof(double));
    if (sum != checksum(bytes.data(), length) || numbers.size() < head_numbers + 1) {
        fail_reading("a field in it is damaged");
    }
    std::memcpy(numbers.data(), bytes.data(), length);
    FieldFrame frame;
    DensityField like;
    frame.dimension = static_cast<int>(numbers[0]);
    like.nx = static_cast<int>(numbers[1]);
    like.ny = static_cast<int>(numbers[2]);
    like.spacing = numbers[3];
    like.step = static_cast<std::int64_t>(numbers[4]);
    like.time = numbers[5];
    const auto replicas = static_cast<std::size_t>(numbers[6]);
    frame.mean_diffusivity = numbers[7];
    const bool has_order = numbers[8] != 0;
    const std::size_t cells = static_cast<std::size_t>(like.nx) * static_cast<std::size_t>(like.ny);
    if (numbers.size() != head_numbers + 1 + cells * (replicas + (has_order ? 1 : 0))) {
        fail_reading("a field in it is damaged");
    }
    auto next = numbers.begin() + head_numbers + 1;
    const auto take = [&] {
        DensityField field = like;
        field.value.assign(next, next + static_cast<std::ptrdiff_t>(cells));
        next += static_cast<std::ptrdiff_t>(cells);
        return field;
    };
    for (std::size_t r = 0; r < replicas; ++r) frame.density.push_back(take());
    if (has_order) frame.order = take();
    return frame;
}

}  // namespace grainfield::io
