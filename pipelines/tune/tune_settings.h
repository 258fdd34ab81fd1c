#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/film/film.h"
#include "pipelines/tune/tuning.h"
#include "tracking/calibrate/size_choice.h"

namespace grainfield::pipelines {

/// One setting for a run of the tracker.
struct Setting {
    std::string section;  ///< of the configuration file: "calibrate"
    std::string name;     ///< "edge-width"
    std::string value;    ///< as TOML has it: 2.5, true, "dark"

    friend bool operator==(const Setting&, const Setting&) = default;
};

/// Settings for a run on the same film: all that the user gave, with what was estimated in place of
/// what it replaces, and steps no finer than the error of the positions asks for. Options of the
/// film stand in the section "track".
std::vector<Setting> suggested_settings(const Tuning& tuning, const FilmOptions& film);

/// What one of several ways to track a frame sets.
struct TriedSettings {
    tracking::Polarity polarity = tracking::Polarity::dark;
    double diameter = 0;             ///< apparent D [px]
    std::optional<double> evidence;  ///< threshold; empty: as given
};

/// The settings that the user gave, with these in their places.
std::vector<Setting> settings_with(const tracking::TrackOptions& given, const FilmOptions& film,
                                   const TriedSettings& tried);

/// The settings that the user gave, with a size and polarity that calibration weighed in their
/// places. The edge width that was given for another size is left out.
std::vector<Setting> settings_of(const tracking::TrackOptions& given, const FilmOptions& film,
                                 const tracking::SizeCandidate& candidate);

/// The settings that the user gave, with that polarity and the size left to be measured: that of a
/// candidate is rough.
std::vector<Setting> settings_instead(const Tuning& tuning, const FilmOptions& film,
                                      const tracking::SizeCandidate& candidate);

/// They as a configuration file.
std::string toml_of(const std::vector<Setting>& settings);

}  // namespace grainfield::pipelines
