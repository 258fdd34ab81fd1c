#include "pipelines/detail/toml_text.h"

#include <stdexcept>
#include <string>

namespace grainfield::pipelines {

namespace {

class FailedAssertion : public std::logic_error {
 public:
    using std::logic_error::logic_error;
};

bool is_parsed(std::string_view text) {
    try {
        static_cast<void>(toml::parse(text));
    } catch (const FailedAssertion&) {
        return false;
    } catch (const toml::parse_error&) {
        return true;
    }
    return true;
}

/// Of the first `lines` lines.
std::string_view beginning(std::string_view text, std::size_t lines) {
    std::size_t end = 0;
    for (; lines > 0 && end < text.size(); --lines) {
        const std::size_t at = text.find('\n', end);
        end = at == std::string_view::npos ? text.size() : at + 1;
    }
    return text.substr(0, end);
}

/// The parser goes from line to line: it fails on every beginning that holds the line, on none
/// that does not.
toml::source_index failing_line(std::string_view text) {
    std::size_t good = 0;
    std::size_t bad = 1;
    while (beginning(text, bad).size() < text.size() && is_parsed(beginning(text, bad))) bad *= 2;
    while (bad - good > 1) {
        const std::size_t middle = good + (bad - good) / 2;
        (is_parsed(beginning(text, middle)) ? good : bad) = middle;
    }
    return static_cast<toml::source_index>(bad);
}

}  // namespace

void fail_toml(const char* expression) {
    throw FailedAssertion(expression);
}

toml::table parsed_toml(std::string_view text) {
    try {
        return toml::parse(text);
    } catch (const FailedAssertion&) {
        const toml::source_position at{.line = failing_line(text), .column = 1};
        throw toml::parse_error("a key or value that cannot be read", at);
    }
}

}  // namespace grainfield::pipelines
