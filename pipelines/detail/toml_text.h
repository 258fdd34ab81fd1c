#pragma once

#include <string_view>

namespace grainfield::pipelines {

/// What toml++ takes for impossible; texts of users bring it about.
[[noreturn]] void fail_toml(const char* expression);

}  // namespace grainfield::pipelines

// Every source that includes toml++ does so through this file: one meaning of its assertions, which
// would end the process otherwise.
#ifdef TOML_ASSERT
#error "include pipelines/detail/toml_text.h in the place of toml++/toml.h"
#endif
#define TOML_ASSERT(expression) \
    ((expression) ? static_cast<void>(0) : ::grainfield::pipelines::fail_toml(#expression))
#include <toml++/toml.h>

namespace grainfield::pipelines {

/// The text as a table. Throws toml::parse_error, with the line, for whatever is not TOML.
toml::table parsed_toml(std::string_view text);

}  // namespace grainfield::pipelines
