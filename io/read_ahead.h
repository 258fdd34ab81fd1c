#pragma once

#include <memory>

#include "core/frame_source.h"

namespace grainfield::io {

/// The same frames, the next one read in a thread of its own while the caller works on the last:
/// reading costs no time as long as it is faster than the work. Where frames are not taken one
/// after the other, none is read ahead. One more frame is in memory. What
/// the source throws on reading ahead is thrown when that frame is read. The source is used by
/// one thread at a time; asking for any other frame than the next waits for the one under way.
std::unique_ptr<FrameSource> read_ahead(std::unique_ptr<FrameSource> source);

}  // namespace grainfield::io
