#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/frame_source.h"

namespace grainfield::io {

constexpr const char* kAllFrames = "::";

/// Whether the range is "" or "::".
bool selects_all(std::string_view range);

/// For people: "frames 100 to 199", "frames from 50", "last 50 frames", "frames in steps of 4",
/// "frame 7"; "all frames". Throws OptionError if the text is not such a range.
std::string in_words(std::string_view range);

/// The frames "FIRST:END:STEP" of a source, as in a Python slice: END is excluded, negative numbers
/// count from the end, any part may be left out; "7" is frame 7 alone, "" and "::" all.
///
/// `read(position)` counts within the selection; the frame keeps the index and time it has in the
/// source. Throws OptionError if the text is not such a range, if STEP is not positive or if
/// nothing is selected.
std::unique_ptr<FrameSource> select_frames(std::unique_ptr<FrameSource> source,
                                           std::string_view range);

/// A selection in numbers: frames first, first + step, … of a source, `count` of them.
struct FrameSelection {
    std::int64_t first = 0;
    std::int64_t step = 1;
    std::int64_t count = 0;

    friend bool operator==(const FrameSelection&, const FrameSelection&) = default;
};

/// Of a source of `count` frames. Throws as select_frames does.
FrameSelection frame_selection(std::string_view range, std::int64_t count);

/// The same, but all of a source without frames is no error.
FrameSelection selection_or_none(std::string_view range, std::int64_t count);

/// Part of a film: the film's frames in the source, and the positions of the part among them.
struct FilmPart {
    FrameSelection film;
    FrameSpan span;
};

/// `range` as a part of the frames `film`; if that is empty, of all frames with the step of the
/// range. Throws OptionError if a range is not one, or if the part has frames that the film has
/// not.
FilmPart part_of_film(std::string_view range, std::string_view film, std::int64_t count);

}  // namespace grainfield::io
