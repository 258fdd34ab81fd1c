#pragma once

#include "core/frame_source.h"

namespace grainfield::fuzz {

/// Reads the first frames in order and the very first once more, and checks the promises of
/// FrameSource (see `promise`).
void read_some(FrameSource& frames);

}  // namespace grainfield::fuzz
