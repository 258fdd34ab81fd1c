#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.h"
#include "io/colour_filter.h"
#include "io/frame_range.h"
#include "pipelines/film/evened_frames.h"
#include "pipelines/film/watched_frames.h"
#include "pipelines/job.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// Which frames are looked at, and what is known of the picture besides the spheres.
struct FilmOptions {
    std::optional<double> fps;  ///< [1/s]; empty: as the file says
    std::string frames = io::kAllFrames;
    bool is_part = false;     ///< the frames are a part of the film
    std::string part_of;      ///< frames of the whole; empty: all, in steps alike
    std::vector<int> region;  ///< X,Y,WIDTH,HEIGHT [px]; empty: all
    io::ColourFilter mosaic = io::ColourFilter::none;     ///< none: grey frames
    io::MosaicChannel channel = io::MosaicChannel::grey;  ///< what is made of a mosaic
    std::string flat_field;                               ///< picture of the empty, lit cell
    std::string mask;                                     ///< picture, zero: not looked at
    std::string background = "none";                      ///< none, static, running, or a picture
    std::int64_t background_frames = 48;                  ///< looked at for one estimate
    std::int64_t background_window = 1000;  ///< [frames] running: what one estimate sees
    std::int64_t max_pixels = 200'000'000;
    bool strict = false;
};

/// Where the background comes from. Throws OptionError.
BackgroundOptions background_of(const FilmOptions& options);

/// The files besides the frames that they name: mask, flat field, picture of the background.
std::vector<std::string> pictures_of(const FilmOptions& options);

/// Adds the rows to a command's own table.
void describe(FilmOptions& options, OptionTable& table);

/// The frames as a tracker sees them: selected, over the flat field, the region alone, background
/// evened out, read ahead. Of a part they are those of the whole film, so that calibration,
/// background and light are the same for all parts.
struct Film {
    std::unique_ptr<WatchedFrames> frames;
    Vec2 origin;                       ///< of the region in the frames of the source [px]
    int whole_width = 0;               ///< of the frames of the source [px]
    int whole_height = 0;              ///< likewise [px]
    tracking::VisiblePixels visible;   ///< where the mask is not zero
    std::optional<io::FilmPart> part;  ///< what is asked for; empty: all frames
    std::optional<double> pixel_mm;    ///< side of a pixel, where the file says it [mm]
};

/// What is done to the frames goes into the plan of the job; a background is estimated with the
/// image model that `tracking` calibrates. Throws OptionError, InputError.
Film open_film(Job& job, const FilmOptions& options, const tracking::TrackOptions& tracking);

/// The same of frames that are filmed while they are tracked; the source has chosen which. Throws
/// OptionError too if the background is to be estimated from frames to come.
Film live_film(std::unique_ptr<FrameSource> frames, const FilmOptions& options,
               const tracking::TrackOptions& tracking, Job& job);

}  // namespace grainfield::pipelines
