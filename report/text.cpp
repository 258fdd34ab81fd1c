#include "report/text.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/support/output_file.h"

namespace grainfield::report {

namespace {

// Length of the well-formed UTF-8 sequence that `text` starts with, 0 if malformed (overlong forms,
// surrogates and code points beyond U+10FFFF included).
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0U) != 0x80) return 0;
    }
    if (first == 0xE0 && byte(1) < 0xA0) return 0;
    if (first == 0xED && byte(1) > 0x9F) return 0;
    if (first == 0xF0 && byte(1) < 0x90) return 0;
    if (first == 0xF4 && byte(1) > 0x8F) return 0;
    return length;
}

std::string superscript(std::string_view digits) {
    static constexpr std::array<const char*, 10> raised{"⁰", "¹", "²", "³", "⁴",
                                                        "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string out;
    for (char c : digits) {
        if (c == '-') out += "⁻";
        if (c >= '0' && c <= '9') out += raised[static_cast<std::size_t>(c - '0')];
    }
    return out;
}

int decade_of(double value) {
    return static_cast<int>(std::floor(std::log10(std::abs(value))));
}

// Decade of the second significant digit of an error, after rounding to two (9.96 is 10).
int last_decade(double error) {
    const int last = decade_of(error) - 1;
    return std::round(error * std::pow(10.0, -last)) >= 100 ? last + 1 : last;
}

}  // namespace

std::string clean_text(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        const auto first = static_cast<unsigned char>(text[0]);
        const bool is_c1 =
            length == 2 && first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
        if (length == 0) {
            out += "\xEF\xBF\xBD";
        } else if (first < 0x20 || first == 0x7F || is_c1) {
            out += ' ';
        } else {
            out += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out;
}

std::string escape_html(std::string_view text) {
    std::string out;
    for (char c : clean_text(text)) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string escape_json_for_script(std::string_view json) {
    std::string out;
    out.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (c == '<') {
            out += "\\u003c";
        } else if (c == '>') {
            out += "\\u003e";
        } else if (c == '&') {
            out += "\\u0026";
        } else if (json.substr(i, 3) == "\xE2\x80\xA8") {
            out += "\\u2028";
            i += 2;
        } else if (json.substr(i, 3) == "\xE2\x80\xA9") {
            out += "\\u2029";
            i += 2;
        } else {
            out += c;
        }
    }
    return out;
}

std::string json_string(std::string_view text) {
    return escape_json_for_script(nlohmann::json(clean_text(text)).dump());
}

std::string base64(std::span<const std::uint8_t> bytes) {
    static constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t j = 0; j < 3; ++j) word = word << 8U | (j < left ? bytes[i + j] : 0U);
        for (std::size_t j = 0; j < 4; ++j) {
            out += j <= left ? digits[word >> (18 - 6 * j) & 63U] : '=';
        }
    }
    return out;
}

std::vector<std::uint8_t> bytes_of_hex(std::string_view hex) {
    const auto digit = [](char c) { return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10; };
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<std::uint8_t>(digit(hex[i]) * 16 + digit(hex[i + 1])));
    }
    return bytes;
}

std::string csv_cell(std::string_view text) {
    std::string out = clean_text(text);
    if (out.find_first_of(",\"") == std::string::npos) return out;
    std::string quoted = "\"";
    for (char c : out) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

std::string csv_cell(double value) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "";
}

std::string order_symbol(const Results& run) {
    static constexpr std::array<const char*, 10> lowered{"₀", "₁", "₂", "₃", "₄",
                                                         "₅", "₆", "₇", "₈", "₉"};
    std::string digits = "4";
    if (const ObservableResult* q4 = run.find("q4"); q4 != nullptr) {
        for (const auto& [name, value] : q4->options) {
            const auto* symmetry = std::get_if<std::int64_t>(&value);
            if (name == "symmetry" && symmetry != nullptr) digits = std::to_string(*symmetry);
        }
    }
    std::string out = "|Q";
    for (char c : digits)
        out += c >= '0' && c <= '9' ? lowered[static_cast<std::size_t>(c - '0')] : "";
    return out + "|";
}

std::string power_of_ten(int exponent) {
    return "10" + superscript(std::to_string(exponent));
}

std::string with_error(double value, const double* error) {
    const bool has_error = error != nullptr && std::isfinite(*error) && *error > 0;
    if (!std::isfinite(value)) return "–";
    const double size = std::max(std::abs(value), has_error ? *error : 0.0);
    int exponent = 0;
    if (size > 0 && (size >= 1e6 || size < 1e-3)) exponent = decade_of(size);
    const double scale = std::pow(10.0, -exponent);
    const std::string power = exponent == 0 ? "" : " × " + power_of_ten(exponent);
    if (!has_error) return fmt::format("{:.4g}", value * scale) + power;
    const double scaled = *error * scale;
    const int last = last_decade(scaled);
    const int places = std::max(0, -last);
    // Digits before the point that the error does not support become zeros.
    const double unit = std::pow(10.0, std::max(0, last));
    const auto whole = [unit](double x) { return unit > 1 ? std::round(x / unit) * unit : x; };
    const std::string text =
        fmt::format("{:.{}f} ± {:.{}f}", whole(value * scale), places, whole(scaled), places);
    return exponent == 0 ? text : "(" + text + ")" + power;
}

std::string number_text(double value, const char* format) {
    return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "–";
}

std::string interval_text(double low, double high) {
    const double size = std::max(std::abs(low), std::abs(high));
    int exponent = 0;
    if (size > 0 && (size >= 1e6 || size < 1e-3)) exponent = decade_of(size);
    const double scale = std::pow(10.0, -exponent);
    const std::string text =
        with_minus_signs(fmt::format("{:.3g} … {:.3g}", low * scale, high * scale));
    return exponent == 0 ? text : "(" + text + ") × " + power_of_ten(exponent);
}

std::string with_minus_signs(std::string text) {
    for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 1)) {
        const bool is_number =
            at + 1 < text.size() &&
            ((text[at + 1] >= '0' && text[at + 1] <= '9') || text[at + 1] == '.');
        if (is_number) text.replace(at, 1, "−");
    }
    return text;
}

std::string count_text(double count) {
    if (std::abs(count) >= 1e15) return with_error(count, nullptr);
    if (count != std::floor(count) && std::abs(count) < 1000) return fmt::format("{:.4g}", count);
    std::string digits = fmt::format("{:.0f}", std::abs(count));
    for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
    return (count < 0 ? "-" : "") + digits;
}

void write_file(const std::filesystem::path& path, std::string_view content) {
    grainfield::write_file(path, content, Overwrite::force);
}

}  // namespace grainfield::report
