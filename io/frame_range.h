#pragma once

#include <memory>
#include <string_view>

#include "core/frame_source.h"

namespace grainfield::io {

/// The frames "FIRST:END:STEP" of a source, as in a Python slice: END is excluded, negative numbers
/// count from the end, any part may be left out; "7" is frame 7 alone, "" and "::" all.
///
/// `read(position)` counts within the selection; the frame keeps the index and time it has in the
/// source. Throws OptionError if the text is not such a range, if STEP is not positive or if
/// nothing is selected.
std::unique_ptr<FrameSource> select_frames(std::unique_ptr<FrameSource> source,
                                           std::string_view range);

}  // namespace grainfield::io
