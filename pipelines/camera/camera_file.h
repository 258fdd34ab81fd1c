#pragma once

#include <filesystem>
#include <string>

#include "tracking/camera/camera.h"

namespace grainfield::pipelines {

class TomlValues;

/// The camera as sections of TOML, whose names begin with `before`. Numbers come back with every
/// bit.
std::string text_of(const tracking::Camera& camera, const std::string& before);

/// The whole camera file.
std::string camera_file_text(const tracking::Camera& camera);

/// The sections of text_of. Throws InputError with file and key, and for a camera that cannot
/// correct positions (tracking::fault_of).
tracking::Camera camera_in(TomlValues& values, const std::string& before);

/// Throws InputError with file and key: a file that cannot be read or is no camera file, a key that
/// is missing, unknown or of a wrong value.
tracking::Camera read_camera(const std::filesystem::path& path);

/// Whether the text of a file names itself a camera file.
bool is_camera_file(const std::filesystem::path& path);

}  // namespace grainfield::pipelines
