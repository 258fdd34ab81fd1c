#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/support/checkpoint.h"

namespace grainfield::io {

/// Writes a checkpoint so that a kill at any instant leaves the old one or the new one: temporary
/// name, fsync, rename (OutputFile; an older checkpoint of that name is replaced).
///
/// Layout, little-endian: "grainfield checkpoint" and a zero byte (22 bytes), u32 format version,
/// u64 length of the JSON header, header (kind, configuration, texts, name and length of each
/// array), the arrays in the order of the header, u32 CRC-32 of everything before it. About 1 GB/s.
///
/// Throws OutputError as OutputFile does, and when the disk is full; the old checkpoint then stays.
void write_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// What stored state is read for: messages say what to do.
enum class CheckpointUse {
    resume,  ///< to go on with an interrupted run
    merge    ///< to add it to that of other parts of an analysis
};

/// Exactly what was written, every bit. Throws InputError, naming the file, if it is missing, not a
/// checkpoint, of another format version, cut short or damaged (checksum).
Checkpoint read_checkpoint(const std::filesystem::path& path,
                           CheckpointUse use = CheckpointUse::resume);

/// Throws InputError that shows each option in which the checkpoint differs from `configuration`
/// ("nu: 0.01 in the checkpoint, 0.003 now"), options that only one of them has included. The order
/// of options does not matter. `path` is for the message.
void require_same_configuration(
    const Checkpoint& checkpoint,
    const std::vector<std::pair<std::string, std::string>>& configuration,
    const std::filesystem::path& path, CheckpointUse use = CheckpointUse::resume);

}  // namespace grainfield::io
