#pragma once

#include <string>

#include "tests/support/program.h"

namespace grainfield::testing {

/// The words of `simulate md` for so many grains in a square cell of that side [a].
inline Words md_words(const std::string& grains, const std::string& side) {
    return {"simulate", "md", "--grains", grains, "--length-x", side, "--length-y", side};
}

/// A liquid that takes about a second for 400 periods.
inline Words small_md() {
    return md_words("400", "20.5");
}

}  // namespace grainfield::testing
