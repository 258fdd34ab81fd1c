#include "io/text/number_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace grainfield::io {

void append_number(std::string& text, double value) {
    if (std::isnan(value)) return;
    constexpr double exact_integers = 9007199254740992.0;  // 2^53
    const bool is_whole = std::abs(value) < exact_integers && value == std::floor(value);
    if (is_whole && !(value == 0 && std::signbit(value))) {
        append_number(text, static_cast<std::int64_t>(value));
        return;
    }
    std::array<char, 32> buffer;
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    text.append(buffer.data(), result.ptr);
}

void append_number(std::string& text, std::int64_t value) {
    std::array<char, 24> buffer;
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    text.append(buffer.data(), result.ptr);
}

void append_field(std::string& text, std::string_view field) {
    if (field.find_first_of(",\"\r\n") == std::string_view::npos) {
        text += field;
        return;
    }
    text += '"';
    for (const char c : field) {
        if (c == '"') text += '"';
        text += c;
    }
    text += '"';
}

}  // namespace grainfield::io
