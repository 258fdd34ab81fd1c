#pragma once

#include <filesystem>

namespace grainfield {

/// The temporary of an OutputFile of this process stays where it is when that is destroyed, for
/// content that is worth more than nothing though it is not whole. Safe from any thread.
void leave_temporary(const std::filesystem::path& temporary);

}  // namespace grainfield
