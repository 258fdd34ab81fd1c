#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/results.h"
#include "core/trajectory.h"

namespace grainfield::report {

/// The same text with every malformed UTF-8 sequence replaced by U+FFFD and every control character
/// by a space, so that it may stand in HTML, XML and JSON.
std::string clean_text(std::string_view text);

/// Clean text that is inert in HTML and XML, between tags and in quoted attributes.
std::string escape_html(std::string_view text);

/// JSON that may stand inside <script>: `<`, `>`, `&`, U+2028 and U+2029 as \u escapes. The input
/// must be valid JSON, where these characters occur in strings only.
std::string escape_json_for_script(std::string_view json);

/// `text` as a JSON string, in quotes, fit for <script>.
std::string json_string(std::string_view text);

/// RFC 4648 with padding.
std::string base64(std::span<const std::uint8_t> bytes);
std::vector<std::uint8_t> bytes_of_hex(std::string_view hex);

/// A cell of a CSV file (RFC 4180): quoted where it must be. Numbers: six digits, empty if not
/// finite.
std::string csv_cell(std::string_view text);
std::string csv_cell(double value);

/// "|Q₄|", or "|Q₆|" where the run was asked for that symmetry.
std::string order_symbol(const Results& run);

/// "0.0312 ± 0.0012": the error to two digits, the value to the same place; without an error the
/// value to four digits; powers of ten where the number is very large or small.
std::string with_error(double value, const double* error);

/// The number as `format` says ("{:.5f}"), "–" if not finite.
std::string number_text(double value, const char* format);

/// "(−9.98 … −4.25) × 10⁻⁴": both ends in the decade of the larger one.
std::string interval_text(double low, double high);

/// Each hyphen before a digit or point becomes a minus sign.
std::string with_minus_signs(std::string text);

/// "12,345", to the whole number from 1000 on; four digits below.
std::string count_text(double count);

/// "10⁻³"
std::string power_of_ten(int exponent);

/// Writes under a temporary name beside the target and renames. Throws OutputError.
void write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace grainfield::report
