#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "core/run_identity.h"

namespace grainfield {

/// The words that files have for where particles or fields come from.
inline constexpr std::array<std::pair<Origin, std::string_view>, 5> origin_names{
    {{Origin::video, "video"},
     {Origin::md, "md"},
     {Origin::rendered, "rendered"},
     {Origin::points, "points"},
     {Origin::field, "field"}}};

/// What a word of a file means; nothing for another word.
constexpr std::optional<Origin> origin_called(std::string_view word) {
    const auto* const found =
        std::ranges::find(origin_names, word, &std::pair<Origin, std::string_view>::second);
    return found == origin_names.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace grainfield
