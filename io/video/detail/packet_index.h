#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/detail/libav.h"

namespace grainfield::io {

/// One packet of a video stream = one frame, as found when the file was read through once.
struct IndexedPacket {
    std::int64_t pts = AV_NOPTS_VALUE;  ///< [time base of the stream]
    std::int64_t dts = AV_NOPTS_VALUE;  ///< [time base of the stream]
    std::int64_t position = -1;         ///< [byte]
    int size = 0;                       ///< [byte]
    int flags = 0;                      ///< AV_PKT_FLAG_*
};

/// All packets of a stream in order of decoding.
struct PacketIndex {
    std::vector<IndexedPacket> packets;
    bool all_have_pts = true;
    std::string cut_message;  ///< why the file seems cut; empty if it does not

    /// Number of the packet that is the same as `packet`, recognised by place in the file, or by
    /// decoding time where the container has none. Needs `make_lookup`.
    std::optional<std::size_t> find(const AVPacket& packet) const;
    void make_lookup();

 private:
    std::unordered_map<std::int64_t, std::size_t> by_position_;
    std::unordered_map<std::int64_t, std::size_t> by_dts_;
};

/// Opens a container with one video stream selected; playlists and other formats that name further
/// files are refused. Throws InputError.
LibavPointer<AVFormatContext> open_container(const std::filesystem::path& path, LibavLog& log,
                                             std::int64_t max_pixels, int& stream);

/// Reads all packets of `stream` from the start to the end. A last packet that is cut is left out.
PacketIndex index_packets(AVFormatContext& container, int stream, LibavLog& log);

}  // namespace grainfield::io
