#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "app/command_page.h"

namespace grainfield::app {

/// No line of a help text is longer [columns].
constexpr std::size_t help_width = 100;

enum class HelpExtent { usual, all };

/// Help of one command: how it is called, its inputs, and its options with unit, range and default.
std::string help_text(const CommandPage& page, HelpExtent extent);

/// Help of the program: its commands and its own options. With `group`, such as "simulate", only
/// the commands of that group.
std::string help_text(const ProgramPage& page, const std::string& group = {});

/// The words of `text` in lines of at most `width` columns, of which the first begins behind
/// `first` columns that are there already and the others behind `indent` blanks. A word that is
/// longer stands in a line of its own. A column is one code point of UTF-8.
std::string wrapped(std::string_view text, std::size_t first, std::size_t indent,
                    std::size_t width);

}  // namespace grainfield::app
