#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace grainfield::io {

/// What the description in the first page of a TIFF says of all of them.
struct TiffDescription {
    std::optional<std::uint64_t> pages;  ///< how many there should be
    std::optional<double> frame_rate;    ///< times a second, each of depths × channels pages [1/s]
    std::optional<double> pixel_mm;      ///< side of a pixel [mm]
    std::int64_t depths = 1;             ///< focal planes of each time
    std::int64_t channels = 1;           ///< channels of each time
};

/// Of ImageJ ("images", "finterval", "channels", "slices" beside "frames"; its "fps" is how fast a
/// stack is shown) and OME-XML (the first Pixels element: TimeIncrement, PhysicalSizeX, their
/// units, SizeZ, SizeC without the colours of a page). What is absent or no sensible number stays
/// empty, as does the size of a pixel that is not square.
TiffDescription tiff_description(std::string_view text);

}  // namespace grainfield::io
