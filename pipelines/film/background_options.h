#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace grainfield::pipelines {

/// Where the background of a film comes from.
enum class BackgroundSource {
    smooth,   ///< a smooth surface only, which the tracker fits anyway
    film,     ///< one estimate from the whole film
    running,  ///< estimates that follow the film
    picture,  ///< a picture of the empty, lit cell
};

struct BackgroundOptions {
    BackgroundSource source = BackgroundSource::smooth;
    std::filesystem::path picture;  ///< of BackgroundSource::picture
    std::int64_t frames = 48;       ///< looked at for one estimate
    std::int64_t window = 1000;     ///< [frames] running: what one estimate sees
};

/// Sets source and picture from "none", "static", "running" or the name of a picture. Throws
/// OptionError if the text is empty.
void set_source(BackgroundOptions& options, const std::string& text);

}  // namespace grainfield::pipelines
