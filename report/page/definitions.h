#pragma once

#include <string>
#include <string_view>

namespace grainfield::report {

/// What a symbol or word of the page means, one or two sentences; empty if it needs no words.
std::string_view definition_of(std::string_view term);

/// The text as HTML. The first appearance of each symbol that has a definition shows it on hover
/// and on keyboard focus.
std::string with_definitions(std::string_view text);

/// The whole of `shown` (already HTML) as one term.
std::string defined(const std::string& shown, std::string_view definition);

}  // namespace grainfield::report
