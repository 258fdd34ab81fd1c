#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace grainfield::io {

/// Appends the shortest text that reads back to the same double, whole numbers below 2^53 without
/// an exponent; nothing for NaN, which is how tables write a missing number.
void append_number(std::string& text, double value);
void append_number(std::string& text, std::int64_t value);

/// Appends a field of a CSV file, quoted (RFC 4180) if it holds a comma, a quote or a line break.
void append_field(std::string& text, std::string_view field);

}  // namespace grainfield::io
