#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/frame_source.h"
#include "io/images/image_format.h"

namespace grainfield::io {

/// The files of a recording as it lies on the disk. A folder stands for the pictures or videos in
/// it, in natural order (2 before 10), without hidden files, subfolders and files of other kinds; a
/// name with *, ? or [ that no file has, for the files that match it, likewise in order. Other
/// names stay as they are, also those of files that are not there.
///
/// Throws InputError for a folder without pictures or videos, one that holds several kinds of them,
/// and for a pattern without a match.
std::vector<std::filesystem::path> recording_files(
    const std::vector<std::filesystem::path>& inputs);
std::vector<std::filesystem::path> recording_files(const std::vector<std::filesystem::path>& inputs,
                                                   std::span<const ImageFormat> formats);

/// Opens one file of a recording.
using OpenPart = std::function<std::unique_ptr<FrameSource>(const std::filesystem::path&)>;

/// Several files of several frames each as one film: in natural order, numbered through. Each is
/// opened once here and again when it is read; no more than 16 are open at a time.
///
/// Times go on across the seams. Where the time stamps of the files show a common clock, frames
/// that are absent at a seam are of status missing, as many as the stamps leave room for. Without a
/// common clock each file begins where the one before ended, and a warning says so; another names
/// the parts whose numbers are absent. The frame rate is that of all files,
/// unknown if theirs differ by more than 0.1 %.
///
/// `rate`: given by the user, so that times are index / rate. Throws InputError if sizes or depths
/// differ, a file is given twice, the
/// stamps leave room for more than a million frames at a seam, or what `open` throws.
std::unique_ptr<FrameSource> join_parts(std::vector<std::filesystem::path> files,
                                        const OpenPart& open, std::optional<double> rate);

}  // namespace grainfield::io
