#pragma once

#include <span>
#include <string_view>

namespace grainfield::fuzz {

/// The readers of all files that come from outside. Each gives the bytes to the code that reads
/// such a file, and what was read to the code behind it. Returns whether they were taken.
///
/// To refuse is a good answer if it is an Error that names the file. Throws std::logic_error for
/// one that does not, and for what was taken against the promises of its reader; any other
/// exception passes. Not thread-safe.
bool read_images(std::string_view bytes);
bool read_videos(std::string_view bytes);
bool read_photron(std::string_view bytes);  ///< header and pixels, which are two files
bool read_streams(std::string_view bytes);  ///< of live sources
bool read_trajectories(std::string_view bytes);
bool read_results(std::string_view bytes);
bool read_fields(std::string_view bytes);
bool read_records(std::string_view bytes);  ///< the JSON texts in HDF5 files
bool read_points(std::string_view bytes);
bool read_wavevectors(std::string_view bytes);
bool read_configurations(std::string_view bytes);  ///< cameras and scenes included
bool read_calibrations(std::string_view bytes);
bool read_cameras(std::string_view bytes);
bool read_checkpoints(std::string_view bytes);  ///< without the checksum at their end
bool read_states(std::string_view bytes);       ///< numbers in checkpoints and logs
bool read_logs(std::string_view bytes);

struct Reader {
    std::string_view name;  ///< also of the folder of its seeds
    bool (*read)(std::string_view bytes);
    int inputs;  ///< how many mutated ones each run of the tests tries; what takes 2 s at most
};

/// All of them.
std::span<const Reader> readers();

}  // namespace grainfield::fuzz
