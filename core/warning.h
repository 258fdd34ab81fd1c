#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace grainfield {

/// What a warning is about, where a later step of the work asks.
enum class WarningCode : std::uint8_t {
    other,
    apparent_diameter,  ///< lengths are in apparent diameters D, as the true a was not given
    incomplete,         ///< the run failed on its way: what is there was sampled before
    doubtful_heights,   ///< image and rendering still differ where some spheres are
    other_truth,        ///< what is called the truth does not fit what was found
    unscaled_errors,    ///< standard errors of synthesis are those of the fit alone
    interrupted         ///< a signal ended the run: it may be gone on with
};

/// Something to know about a result: a text for people, a code for programs.
struct Warning {
    WarningCode code = WarningCode::other;
    std::string text;

    friend bool operator==(const Warning&, const Warning&) = default;
};

}  // namespace grainfield
