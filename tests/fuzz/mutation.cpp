#include "tests/fuzz/mutation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <limits>
#include <string_view>

namespace grainfield::fuzz {

namespace {

constexpr std::size_t kLargest = std::size_t{1} << 18U;  // bytes

template <class List>
const auto& one_of(const List& list, RandomStream& random) {
    return list[static_cast<std::size_t>(random.below(std::size(list)))];
}

std::size_t place(const std::string& bytes, RandomStream& random) {
    return static_cast<std::size_t>(random.below(bytes.size()));
}

/// Short pieces more often than long ones.
std::size_t length(std::size_t most, RandomStream& random) {
    const std::uint64_t limit = std::uint64_t{1} << random.below(12);
    return static_cast<std::size_t>(random.below(std::min<std::uint64_t>(limit, most))) + 1;
}

template <class Number>
void put(std::string& bytes, Number value, RandomStream& random) {
    std::array<char, sizeof(Number)> piece{};
    std::copy_n(reinterpret_cast<const char*>(&value), piece.size(), piece.begin());
    if (random.below(4) == 0) std::ranges::reverse(piece);
    const std::size_t at = place(bytes, random);
    const std::size_t size = std::min(piece.size(), bytes.size() - at);
    std::copy_n(piece.begin(), size, bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

template <class Number>
void put_integer(std::string& bytes, RandomStream& random) {
    constexpr std::array<std::int64_t, 11> critical{0,
                                                    1,
                                                    -1,
                                                    2,
                                                    0x7F,
                                                    0xFF,
                                                    0xFFFF,
                                                    0x7FFF,
                                                    0x7FFFFFFF,
                                                    0xFFFFFFFF,
                                                    std::numeric_limits<std::int64_t>::max()};
    put(bytes, static_cast<Number>(one_of(critical, random)), random);
}

void put_double(std::string& bytes, RandomStream& random) {
    using Limits = std::numeric_limits<double>;
    constexpr std::array critical{0.0,
                                  -0.0,
                                  1.0,
                                  -1.0,
                                  0.5,
                                  1e300,
                                  -1e300,
                                  1e19,
                                  2e9,
                                  Limits::quiet_NaN(),
                                  Limits::infinity(),
                                  Limits::denorm_min()};
    put(bytes, one_of(critical, random), random);
}

/// Replaces a number that is written in digits.
void put_text(std::string& bytes, RandomStream& random) {
    constexpr std::array<std::string_view, 16> critical{
        "0",   "-1",   "nan",  "inf", "1e999", "-1e300",     "9223372036854775807",  "1e-320",
        "0x1", "true", "\"\"", "[]",  "",      "2147483648", "-9223372036854775808", "1e15"};
    const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(place(bytes, random));
    const auto begin = std::find_if(from, bytes.end(), is_digit);
    const auto end = std::find_if_not(begin, bytes.end(), is_digit);
    bytes.replace(begin, end, one_of(critical, random));
}

void change(std::string& bytes, const std::vector<std::string>& seeds, RandomStream& random) {
    if (bytes.empty()) bytes = one_of(seeds, random);
    if (bytes.empty()) return;
    const std::size_t at = place(bytes, random);
    const std::size_t size = length(bytes.size() - at, random);
    switch (random.below(12)) {
        case 0:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
            break;
        case 1:
            bytes[at] = static_cast<char>(random.below(256));
            break;
        case 2:
            put_integer<std::int16_t>(bytes, random);
            break;
        case 3:
            put_integer<std::int32_t>(bytes, random);
            break;
        case 4:
            put_integer<std::int64_t>(bytes, random);
            break;
        case 5:
            put_double(bytes, random);
            break;
        case 6:
        case 7:
            put_text(bytes, random);
            break;
        case 8:
            bytes.erase(at, size);
            break;
        case 9:
            bytes.insert(place(bytes, random), bytes.substr(at, size));
            break;
        case 10: {
            const std::string& other = one_of(seeds, random);
            if (!other.empty()) bytes.insert(at, other, place(other, random), size);
            break;
        }
        default:
            bytes.resize(random.below(4) == 0 ? at : bytes.size());
    }
}

}  // namespace

std::string mutated(const std::vector<std::string>& seeds, RandomStream& random) {
    std::string bytes = one_of(seeds, random);
    const std::uint64_t changes = random.below(8) + 1;
    for (std::uint64_t i = 0; i < changes; ++i) change(bytes, seeds, random);
    if (bytes.size() > kLargest) bytes.resize(kLargest);
    return bytes;
}

}  // namespace grainfield::fuzz
