#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace grainfield::io {

/// Whether `a` comes before `b` when runs of digits compare as numbers: "f2" before "f10".
bool natural_less(std::string_view a, std::string_view b);

/// Files by frame index; an empty path is a frame that is missing.
struct NumberedFiles {
    std::vector<std::filesystem::path> files;
    std::vector<std::filesystem::path> missing_names;  ///< as they should be, in order
    std::vector<std::string> warnings;
    std::int64_t step = 0;  ///< from number to number; 0: no number runs through the names
};

/// Puts files in natural order and opens a gap for every absent number, provided that their names
/// differ in one number only, which increases from folder to folder as well. Numbers may run in
/// steps (0, 10, 20 has no gap). Names whose numbers would leave more gaps than files are not
/// counted as a sequence; a warning says so. Throws InputError if a file is given twice.
NumberedFiles number_files(std::vector<std::filesystem::path> files);

}  // namespace grainfield::io
