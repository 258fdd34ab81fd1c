#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/frame_source.h"
#include "io/frame_file_options.h"

namespace grainfield::io {

/// Whether a name is that of a Photron recording: .mraw, .cih or .cihx in any case.
bool is_photron_name(const std::filesystem::path& path);

/// Files without the headers (.cih, .cihx) of recordings that another file of the list stands for:
/// their .mraw, or the .cihx for a .cih. The others stay as they are.
std::vector<std::filesystem::path> each_photron_once(
    const std::vector<std::filesystem::path>& files);

/// Photron recordings: frames without a header in NAME.mraw, and in NAME.cihx (XML) or NAME.cih
/// (lines "Key : Value") beside it what they are. Either file stands for the recording.
///
/// Pixels of 8 bit, of 16 bit little-endian, whose counts are the lower or the higher bits (the
/// effective ones), or of 12 bit packed: two in three bytes, the highest bits first. The frame rate
/// is that of the recording. Frames are those that are there: a cut file keeps its whole ones and
/// warns. So does one whose colour type is not Mono, unless the colour filter is known.
///
/// Throws InputError if one of the two files is absent, if it does not say what is needed, or for
/// other depths.
std::unique_ptr<FrameSource> open_photron(const std::filesystem::path& path,
                                          const FrameFileOptions& options);

}  // namespace grainfield::io
