#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace grainfield {

/// What to do when the target exists already.
enum class Overwrite { refuse, force };

/// An output that appears under its name only when it is complete.
///
/// The content is written to `temporary()`, the target's name + ".partial" beside it. `commit()`
/// brings it to the disk and renames it in one step. Readers see the old file or the whole new one.
/// An object destroyed without a commit removes its temporary. While the object lives, the
/// temporary is locked (flock): a second writer of the same target is refused, in this process or
/// another. A temporary left behind by a killed run has no lock and is overwritten.
///
/// Throws OutputError if the target exists and Overwrite is refuse (names --force), if the target
/// is a directory or a device, if its directory is missing or not writable, if another run is
/// writing it, and from commit() if the data cannot be brought to the disk. File systems without
/// locks are written without this protection.
class OutputFile {
 public:
    OutputFile(std::filesystem::path target, Overwrite overwrite);
    ~OutputFile();
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&&) = delete;

    const std::filesystem::path& target() const { return target_; }
    const std::filesystem::path& temporary() const { return temporary_; }

    void commit();

 private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    Overwrite overwrite_;
    int descriptor_ = -1;  ///< holds the lock; -1 once committed or moved from
};

/// Writes `content` as the whole of a file, as OutputFile does. Throws OutputError.
void write_file(const std::filesystem::path& target, std::string_view content, Overwrite overwrite);

/// Removes the temporaries of every OutputFile of this process; none of them can be committed any
/// more, so that the process must end next. Safe from any thread.
/// Returns how many there were: 0 if all outputs are complete.
std::size_t abandon_outputs();

}  // namespace grainfield
