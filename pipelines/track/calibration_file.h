#pragma once

#include <filesystem>
#include <string>

#include "tracking/calibrate/kept_calibration.h"

namespace grainfield::pipelines {

/// The calibration as TOML. Numbers come back with every bit.
std::string text_of(const tracking::KeptCalibration& kept);

/// Throws InputError with file and key: a file that cannot be read or is no calibration, a key that
/// is missing, unknown or of a wrong value.
tracking::KeptCalibration read_calibration(const std::filesystem::path& path);

}  // namespace grainfield::pipelines
