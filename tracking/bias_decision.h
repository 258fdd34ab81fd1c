#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace grainfield::tracking {

/// Where the correction of positions for mirror images comes from.
enum class BiasSource {
    none,
    general,  ///< learned from other cameras
    film,     ///< learned from frames rendered as a film: this one, or the one calibrated on
};

/// What was decided of the bias of discs, for people and files. It depends on the film and the
/// options alone.
struct BiasDecision {
    BiasSource source = BiasSource::none;
    std::int64_t cameras = 0;  ///< that it was learned from; general alone
    /// RMS by which it moves the spheres of the frame that was judged [a]; general alone.
    std::optional<double> moved;
    /// RMS error per axis where it was not learned: of other cameras, or of synthesised frames [a].
    double before = 0, after = 0;
    std::string reason;  ///< why there is none; none alone

    bool operator==(const BiasDecision&) const = default;
};

/// "general", "film", "none": in files and JSON.
const char* name_of(BiasSource source);
/// The one of that name; empty: none has it.
std::optional<BiasSource> bias_source_named(const std::string& name);

/// "corrected for mirror images of neighbours by 0.0108 a RMS, as learned from 320 other cameras
/// …", or "not corrected: …".
std::string in_words(const BiasDecision& decision);

}  // namespace grainfield::tracking
