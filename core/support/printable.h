#pragma once

#include <string>
#include <string_view>

namespace grainfield {

/// The text as a terminal may be given it: control characters but line feeds and tabs, which names
/// of files may hold, are spelled out ("\x1b"). UTF-8 stays as it is.
std::string printable(std::string_view text);

}  // namespace grainfield
