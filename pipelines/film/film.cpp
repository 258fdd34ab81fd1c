#include "pipelines/film/film.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/frame_files.h"
#include "io/frame_range.h"
#include "io/frame_region.h"
#include "io/frame_scale.h"
#include "io/read_ahead.h"

namespace grainfield::pipelines {

namespace {

/// What is done to the mosaic of a colour camera.
struct Mosaic {
    io::ColourFilter filter = io::ColourFilter::none;
    io::MosaicChannel channel = io::MosaicChannel::grey;
};

/// The first frame that can be read.
std::optional<Image> first_image(FrameSource& frames) {
    for (std::int64_t i = 0; i < frames.count(); ++i) {
        throw_if_interrupted("tracking");
        Frame frame = frames.read(i);
        if (frame.status == FrameStatus::ok) return std::move(frame.image);
    }
    return std::nullopt;
}

Mosaic mosaic_of(FrameSource& frames, const FilmOptions& options, RunPlan& plan) {
    Mosaic mosaic{options.mosaic, options.channel};
    if (mosaic.filter == io::ColourFilter::none) {
        if (options.channel == io::MosaicChannel::grey) return mosaic;
        throw OptionError({.problem = "option 'channel' needs the mosaic of a colour camera",
                           .actual = "no colour filter is named",
                           .expected = "option 'mosaic' rggb, grbg, gbrg or bggr",
                           .suggestion = "leave it out for frames of a grey camera"});
    }
    std::string made = fmt::format("{}, interpolated", io::name_of(mosaic.channel));
    if (mosaic.channel == io::MosaicChannel::best) {
        const std::optional<Image> image = first_image(frames);
        if (!image) return mosaic;
        const std::array<double, 3> contrast = io::contrasts_of(*image, mosaic.filter);
        const auto most = std::ranges::max_element(contrast) - contrast.begin();
        constexpr std::array channels{io::MosaicChannel::red, io::MosaicChannel::green,
                                      io::MosaicChannel::blue};
        mosaic.channel = channels[static_cast<std::size_t>(most)];
        made = fmt::format(
            "{}, interpolated: it has the most contrast (red {:.0f}, green {:.0f}, blue {:.0f} "
            "counts)",
            io::name_of(mosaic.channel), contrast[0], contrast[1], contrast[2]);
    }
    plan.run("mosaic", fmt::format("{} → {}", io::name_of(mosaic.filter), made));
    return mosaic;
}

/// A picture that belongs to the frames, of the same size; `purpose` is for messages.
Image companion(const std::string& path, const char* purpose, const FrameSource& frames,
                const FilmOptions& options, const Mosaic& mosaic = {}) {
    const auto refuse = [&](std::string actual, std::string expected) {
        throw InputError({.problem = fmt::format("cannot use '{}' as {}", path, purpose),
                          .actual = std::move(actual),
                          .expected = std::move(expected),
                          .suggestion = {}});
    };
    const auto source = io::open_frames({path}, {.fps = {}, .max_pixels = options.max_pixels});
    Frame frame = source->read(0);
    if (frame.status != FrameStatus::ok) refuse(frame.message, "a whole picture");
    if (frame.image.width() != frames.width() || frame.image.height() != frames.height()) {
        refuse(fmt::format("it has {} x {} px", frame.image.width(), frame.image.height()),
               fmt::format("{} x {} px, as the whole frames", frames.width(), frames.height()));
    }
    return io::demosaiced(frame.image, mosaic.filter, mosaic.channel);
}

tracking::VisiblePixels visible_pixels(const FrameSource& frames, const FilmOptions& options,
                                       const std::optional<io::FrameRegion>& region,
                                       RunPlan& plan) {
    if (options.mask.empty()) return {};
    Image mask = companion(options.mask, "mask", frames, options);
    const float brightest = std::ranges::max(mask.pixels());
    const auto grey = std::ranges::count_if(
        mask.pixels(), [brightest](float v) { return v > 0 && v < brightest; });
    if (static_cast<double>(grey) > 0.01 * static_cast<double>(mask.size())) {
        plan.warn(fmt::format(
            "the mask '{}' has grey pixels, {:.0f} % of all; they are looked at, "
            "only zero is not: a JPEG or soft borders do not make a mask",
            options.mask, 100 * static_cast<double>(grey) / static_cast<double>(mask.size())));
    }
    tracking::VisiblePixels visible(std::move(mask));
    std::int64_t all = static_cast<std::int64_t>(frames.width()) * frames.height();
    if (region) {
        visible = visible.part(region->x, region->y, region->width, region->height);
        all = static_cast<std::int64_t>(region->width) * region->height;
    }
    const std::int64_t seen = visible.count(all);
    if (seen == 0) {
        throw InputError(
            {.problem = fmt::format("the mask '{}' leaves nothing to look at", options.mask),
             .actual = region ? "it is zero in the whole region" : "it is zero",
             .expected = "pixels above zero where spheres are",
             .suggestion = "turn it round if it is zero where spheres are"});
    }
    if (visible.are_all()) {
        plan.skip("mask", fmt::format("'{}' is nowhere zero", options.mask), "nothing");
    } else {
        plan.run("mask",
                 fmt::format("{:.1f} % of the pixels are not looked at",
                             100 * (1 - static_cast<double>(seen) / static_cast<double>(all))));
    }
    return visible;
}

/// The picture of the background, the region of it; empty if there is none.
Image empty_cell(const FilmOptions& options, const std::optional<io::FrameRegion>& region,
                 const FrameSource& frames, const Mosaic& mosaic) {
    if (background_of(options).source != BackgroundSource::picture) return {};
    const Image whole = companion(options.background, "background", frames, options, mosaic);
    return region ? io::cropped(whole, *region) : whole;
}

std::string origin_of(const BackgroundOptions& background, bool is_running) {
    switch (background.source) {
        case BackgroundSource::smooth:
            return "none";
        case BackgroundSource::film:
            return "static";
        case BackgroundSource::running:
            return is_running ? "running" : "static (film shorter than the window)";
        case BackgroundSource::picture:
            return "as in '" + background.picture.string() + "'";
    }
    return "";
}

void plan_background(const FilmOptions& options, const EvenedFrames& evened, RunPlan& plan) {
    const tracking::Evening& evening = evened.first();
    plan.run("background",
             fmt::format("{}: {:.2f} % of the pixels differ from a smooth surface, by up to {:.2f} "
                         "of the contrast, and are evened out; {:.2f} % are never clear",
                         origin_of(background_of(options), evened.is_running()),
                         100 * evening.uneven, evening.strongest, 100 * evening.never_clear));
    constexpr double too_much = 0.2;
    if (evening.never_clear > too_much) {
        plan.warn(
            fmt::format("background: {:.0f} % of the pixels are never clear in the frames looked "
                        "at: the film is too short or "
                        "too slow for its own background; use more frames (background-frames, "
                        "background-window) or a picture of the empty cell",
                        100 * evening.never_clear));
    } else if (evening.never_clear > 0.01) {
        plan.warn(fmt::format(
            "background: {:.0f} % of the pixels are never clear in the frames looked at; spheres "
            "that rest there are kept, dirt that blocks all light needs a mask",
            100 * evening.never_clear));
    }
}

/// Frames with the background evened out; those that came in where there is nothing to do.
std::unique_ptr<FrameSource> evened(std::unique_ptr<FrameSource> frames, const FilmOptions& options,
                                    const Image& empty_cell, const tracking::TrackOptions& tracking,
                                    Job& job) {
    RunPlan& plan = job.plan;
    const BackgroundOptions background = background_of(options);
    if (background.source == BackgroundSource::smooth) return frames;
    if (empty_cell.empty() && frames->count() < 3) {
        plan.skip("background", "fewer than three frames", "one pass over each frame");
        return frames;
    }
    RunPlan scratch;
    tracking::TrackOptions measured = tracking;
    measured.corrects_bias = false;  // nor are blocks tried
    const tracking::Tracker first(*frames, measured, scratch);
    if (!first.is_calibrated()) return frames;  // which is said when the tracker tries again
    const auto levels = tracking::FilmLevels::of(first.model(), frames->width(), frames->height());
    std::unique_ptr<EvenedFrames> evened;
    if (!empty_cell.empty()) {
        evened = std::make_unique<EvenedFrames>(std::move(frames), empty_cell, levels,
                                                tracking.visible, job.threads);
    } else {
        evened = std::make_unique<EvenedFrames>(std::move(frames), background, levels,
                                                tracking.visible, job.threads);
    }
    throw_if_interrupted("tracking");
    plan_background(options, *evened, plan);
    return evened;
}

}  // namespace

BackgroundOptions background_of(const FilmOptions& options) {
    BackgroundOptions background;
    background.frames = options.background_frames;
    background.window = options.background_window;
    set_source(background, options.background);
    return background;
}

std::vector<std::string> pictures_of(const FilmOptions& options) {
    std::vector<std::string> pictures;
    for (const std::string& path : {options.mask, options.flat_field}) {
        if (!path.empty()) pictures.push_back(path);
    }
    if (background_of(options).source == BackgroundSource::picture) {
        pictures.push_back(options.background);
    }
    return pictures;
}

void describe(FilmOptions& options, OptionTable& table) {
    table.number("fps", options.fps, "1/s", {1e-9, 1e9}, "frame rate; auto: as the file says");
    table.text("frames", options.frames, "which frames, as FIRST:END:STEP");
    table.integers("region", options.region, "px", {0, 1e9},
                   "part of the frames to track, as X,Y,WIDTH,HEIGHT", {4, 4});
    table.choice("mosaic", options.mosaic,
                 {{"auto", io::ColourFilter::none},
                  {"rggb", io::ColourFilter::rggb},
                  {"grbg", io::ColourFilter::grbg},
                  {"gbrg", io::ColourFilter::gbrg},
                  {"bggr", io::ColourFilter::bggr}},
                 "colour filter of raw frames, first two pixels of two rows; auto: none");
    table.choice(
        "channel", options.channel,
        {{"grey", io::MosaicChannel::grey},
         {"best", io::MosaicChannel::best},
         {"red", io::MosaicChannel::red},
         {"green", io::MosaicChannel::green},
         {"blue", io::MosaicChannel::blue}},
        "what is made of a mosaic: grey in white light; best: the colour of most contrast");
    table.text("flat-field", options.flat_field,
               "picture of the empty, lit cell to divide the frames by");
    table.text("mask", options.mask,
               "picture of the size of the frames: where it is zero is not looked at");
    table.text("background", options.background,
               "dirt and stains: none (a smooth surface only), static, running, or a picture of "
               "the empty cell");
    table.integer("background-frames", options.background_frames, "frames", {3, 1000},
                  "looked at for one estimate of the background");
    table.integer("background-window", options.background_window, "frames", {10, 1e9},
                  "running: what one estimate of the background sees");
    table.integer("max-pixels", options.max_pixels, "px", {1, 1e11}, "largest frame accepted");
    table.affects(Effect::work);
    table.flag("strict", options.strict, "fail on the first bad frame instead of leaving it out");
    table.affects(Effect::work);
}

namespace {

/// What is done to frames between the source and the tracker. `range`: which are wanted; empty:
/// the source has chosen.
Film prepared(Film film, std::unique_ptr<FrameSource> frames, const std::string& range,
              const FilmOptions& options, const tracking::TrackOptions& tracking, Job& job) {
    const Mosaic mosaic = mosaic_of(*frames, options, job.plan);
    frames = io::demosaic_frames(std::move(frames), mosaic.filter, mosaic.channel);
    if (!range.empty()) frames = io::select_frames(std::move(frames), range);
    film.whole_width = frames->width();
    film.whole_height = frames->height();
    const auto region = io::region_within(options.region, frames->width(), frames->height());
    film.visible = visible_pixels(*frames, options, region, job.plan);
    if (region) film.origin = {static_cast<double>(region->x), static_cast<double>(region->y)};
    if (!options.flat_field.empty()) {
        const Image flat = companion(options.flat_field, "flat field", *frames, options, mosaic);
        frames = io::flatten_frames(std::move(frames), flat);
    }
    const Image empty = empty_cell(options, region, *frames, mosaic);
    if (!options.flat_field.empty() && !empty.empty()) {
        throw OptionError(
            {.problem = "a flat field and a picture as background correct the same light twice",
             .actual = options.background,
             .expected = "one of them",
             .suggestion = "leave out the flat field, or estimate the background from the film"});
    }
    if (region) frames = io::crop_frames(std::move(frames), *region);
    tracking::TrackOptions first = tracking;
    first.visible = film.visible;
    // The thread that reads ahead does not compute: what is evened out comes behind it. Live frames
    // come in a thread of their own.
    if (!range.empty()) frames = io::read_ahead(std::move(frames));
    frames = evened(std::move(frames), options, empty, first, job);
    film.frames = std::make_unique<WatchedFrames>(
        std::move(frames), options.strict ? BadFrames::refuse : BadFrames::allow);
    for (const std::string& warning : film.frames->warnings()) job.plan.warn(warning);
    return film;
}

}  // namespace

Film open_film(Job& job, const FilmOptions& options, const tracking::TrackOptions& tracking) {
    std::unique_ptr<FrameSource> frames =
        io::open_frames(job.inputs, {.fps = options.fps,
                                     .max_pixels = options.max_pixels,
                                     .knows_filter = options.mosaic != io::ColourFilter::none});
    Film film;
    if (const auto* scale = dynamic_cast<const io::FrameScale*>(frames.get())) {
        film.pixel_mm = scale->pixel_mm();
    }
    std::string range = options.frames.empty() ? io::kAllFrames : options.frames;
    if (options.is_part) {
        film.part = io::part_of_film(options.frames, options.part_of, frames->count());
        const io::FrameSelection& whole = film.part->film;
        range = fmt::format("{}:{}:{}", whole.first,
                            whole.first + (whole.count - 1) * whole.step + 1, whole.step);
    }
    return prepared(std::move(film), std::move(frames), range, options, tracking, job);
}

Film live_film(std::unique_ptr<FrameSource> frames, const FilmOptions& options,
               const tracking::TrackOptions& tracking, Job& job) {
    const BackgroundSource background = background_of(options).source;
    if (background == BackgroundSource::film || background == BackgroundSource::running) {
        throw OptionError({.problem = "a background cannot be estimated from frames to come",
                           .actual = fmt::format("option 'background' is '{}'", options.background),
                           .expected = "none, or a picture of the empty cell",
                           .suggestion = {}});
    }
    return prepared({}, std::move(frames), "", options, tracking, job);
}

}  // namespace grainfield::pipelines
