#include "pipelines/camera/camera_job.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/output_file.h"
#include "core/support/progress.h"
#include "io/frame_files.h"
#include "io/joined_films.h"
#include "pipelines/camera/camera_file.h"
#include "pipelines/camera/residual_picture.h"
#include "tracking/camera/board_points.h"
#include "tracking/camera/rectangle_view.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;
using tracking::BoardView;

constexpr double kFarReach = 0.8;  // of the way to the corners
constexpr double kPoorFit = 0.3;   // px
// Boards are made to a few thousandths of their pitch. Spheres of a crystal move by 0.05 of their
// spacing or more before it melts (Lindemann's rule: at 0.1 to 0.15).
constexpr double kMostUneven = 0.02;  // residual [pitch]
constexpr std::size_t kCorners = 8;   // numbers of four corners

/// A picture to look at, by its place in a file.
struct Place {
    fs::path file;
    std::int64_t frame = 0, frames = 1;

    std::string name() const {
        return frames == 1 ? fmt::format("'{}'", file.string())
                           : fmt::format("frame {} of '{}'", frame, file.string());
    }
};

std::vector<Place> places_of(const Job& job) {
    std::vector<Place> places;
    for (const fs::path& file : job.inputs) {
        const std::int64_t frames = io::open_frames({file}, {})->count();
        for (std::int64_t i = 0; i < frames; ++i) places.push_back({file, i, frames});
        throw_if_interrupted("calibrate-camera");
    }
    return places;
}

/// The number of the picture of the cell's plane. Throws OptionError where there is none.
std::size_t cell_picture(const std::vector<Place>& places, const CameraJobOptions& options) {
    const auto count = static_cast<std::int64_t>(places.size());
    if (options.cell_picture < count) return static_cast<std::size_t>(options.cell_picture);
    throw OptionError({.problem = "option 'cell-picture' names none of the pictures",
                       .actual = fmt::format("{} of {}", options.cell_picture, count),
                       .expected = fmt::format("0 to {}", count - 1),
                       .suggestion = {}});
}

/// As many as wanted, spread evenly; the one of the cell's plane among them. Gives its new number.
std::size_t thin_out(std::vector<Place>& places, const CameraJobOptions& options) {
    const auto count = static_cast<std::int64_t>(places.size());
    const auto cell = static_cast<std::int64_t>(cell_picture(places, options));
    if (count <= options.pictures) return static_cast<std::size_t>(cell);
    std::vector<Place> kept;
    std::size_t number = 0;
    for (std::int64_t i = 0; i < options.pictures; ++i) {
        std::int64_t at = i * count / options.pictures;
        const std::int64_t next = (i + 1) * count / options.pictures;
        if (cell >= at && cell < next) {
            at = cell;
            number = kept.size();
        }
        kept.push_back(places[static_cast<std::size_t>(at)]);
    }
    places = std::move(kept);
    return number;
}

Image image_of(const Place& place) {
    Frame frame = io::open_frames({place.file}, {})->read(place.frame);
    if (frame.status == FrameStatus::ok) return std::move(frame.image);
    throw InputError({.problem = place.name() + " cannot be read",
                      .actual = frame.message,
                      .expected = "a whole picture",
                      .suggestion = "leave it out"});
}

void require_size(const Image& image, const Image& first, const Place& place) {
    if (image.width() == first.width() && image.height() == first.height()) return;
    throw InputError(
        {.problem = "the pictures are not of one size",
         .actual = fmt::format("{} has {} x {} px", place.name(), image.width(), image.height()),
         .expected = fmt::format("{} x {} px, as the first", first.width(), first.height()),
         .suggestion = "take all with the settings of the film"});
}

BoardView look_for(const Image& image, const CameraJobOptions& options, BoardKind& kind,
                   int threads) {
    if (kind != BoardKind::dots) {
        BoardView view = tracking::find_chessboard(image, options.inner_corners);
        if (!view.empty()) kind = BoardKind::chessboard;
        if (kind == BoardKind::chessboard) return view;
    }
    BoardView view = tracking::find_dots(image, threads);
    if (view.is_usable() && view.is_most_of_the_picture()) {
        kind = BoardKind::dots;
        return view;
    }
    BoardView none;
    none.spots = view.spots;
    return none;
}

const char* name_of(BoardKind kind) {
    switch (kind) {
        case BoardKind::chessboard:
            return "a chessboard";
        case BoardKind::dots:
            return "dots";
        case BoardKind::automatic:
            break;
    }
    return "a chessboard or dots";
}

/// Throws OptionError for what only boards have.
void refuse_board_options(const CameraJobOptions& options) {
    const char* name = options.pitch                           ? "pitch"
                       : !options.inner_corners.empty()        ? "inner-corners"
                       : options.board != BoardKind::automatic ? "board"
                                                               : nullptr;
    if (name == nullptr) return;
    throw OptionError(
        {.problem = fmt::format("option '{}' is for pictures of a board", name),
         .actual = fmt::format("the plane is that of a rectangle (option '{}'), "
                               "whose sides say the scale",
                               options.walls ? "walls" : "corners"),
         .expected = "a board or a rectangle",
         .suggestion = fmt::format("leave out option '{}', or option '{}' and option 'sides'", name,
                                   options.walls ? "walls" : "corners")});
}

bool is_of_corners(const CameraJobOptions& options) {
    if (options.corners && options.walls) {
        throw OptionError({.problem = "corners are given, and walls are to be looked for",
                           .actual = {},
                           .expected = "option 'corners' or option 'walls'",
                           .suggestion = {}});
    }
    const bool is_rectangle = options.corners || options.walls;
    if (is_rectangle && !options.sides) {
        throw OptionError(
            {.problem = "how long the sides of the rectangle are is not known",
             .actual = "option 'sides' is not given",
             .expected = options.walls ? "the level and the upright side of the cell, as W,H in "
                                         "'unit'"
                                       : "the lengths from the first corner to the second, and "
                                         "from there to the third, as W,H in 'unit'",
             .suggestion = "measure the cell; 60,40 is 60 mm wide and 40 mm high"});
    }
    if (!is_rectangle && options.sides) {
        throw OptionError({.problem = "sides are given without a rectangle",
                           .actual = "neither option 'corners' nor option 'walls' is given",
                           .expected = "option 'walls', which looks for the cell, or option "
                                       "'corners' as X,Y,X,Y,X,Y,X,Y [px]",
                           .suggestion = "of a board give option 'pitch' instead"});
    }
    if (is_rectangle) refuse_board_options(options);
    return is_rectangle;
}

double largest_shift(const tracking::Camera& camera) {
    const tracking::CameraMap map(camera);
    constexpr int steps = 32;
    double largest = 0;
    for (int j = 0; j <= steps; ++j) {
        for (int i = 0; i <= steps; ++i) {
            const Vec2 p{camera.width * static_cast<double>(i) / steps - 0.5,
                         camera.height * static_cast<double>(j) / steps - 0.5};
            largest = std::max(largest, norm(map.corrected(p).position - p));
        }
    }
    return largest;
}

std::array<Vec2, 4> given_corners(const std::vector<double>& numbers) {
    std::array<Vec2, 4> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        corners[i] = {numbers[2 * i], numbers[2 * i + 1]};
    }
    return corners;
}

/// "60,40: seen from 3° aside, corners off by 0.2 px"
std::string in_words(double first, double second, const tracking::RectangleView& view) {
    return fmt::format("{:g},{:g}: seen from {:.0f}° aside, corners off by {:.1f} px", first,
                       second, view.tilt, view.misfit);
}

/// Throws OptionError for sides that only the other order explains; warns where it is likelier, or
/// where no usual camera sees such a rectangle.
void require_order(const std::array<Vec2, 4>& corners, double first, double second,
                   const Image& image, RunPlan& plan) {
    constexpr double refused = 9;  // of doubt, that is three usual deviations
    constexpr double noted = 2;
    const auto view = [&](double a, double b) {
        return tracking::rectangle_view(corners, a, b, image.width(), image.height());
    };
    const tracking::RectangleView given = view(first, second);
    const tracking::RectangleView swapped = view(second, first);
    const double worse = given.doubt - swapped.doubt;
    const std::string readings =
        fmt::format("{}; {}", in_words(first, second, given), in_words(second, first, swapped));
    if (worse > refused && swapped.is_likely) {
        throw OptionError(
            {.problem = "the two lengths of option 'sides' are in the wrong order",
             .actual = readings,
             .expected = "level side, upright side (walls), or the side from the "
                         "first corner to the second, then the next (corners)",
             .suggestion = fmt::format("give option 'sides' as {:g},{:g}", second, first)});
    }
    if (worse > noted) {
        plan.warn(
            fmt::format("the lengths of option 'sides' may be in the wrong order: {}", readings));
    } else if (given.doubt > refused) {
        plan.warn(fmt::format(
            "the lengths of option 'sides' do not suit the picture: {}; are they those of the "
            "rectangle that was found, and are pixels square?",
            in_words(first, second, given)));
    }
}

CameraJobResult of_rectangle(const CameraJobOptions& options, const Place& place, RunPlan& plan) {
    const Image image = image_of(place);
    CameraJobResult result;
    result.pictures = 1;
    if (options.walls) {
        result.walls = tracking::find_walls(image);
        constexpr double bent = 0.3;  // px
        if (result.walls->residual_rms > bent) {
            plan.warn(fmt::format(
                "the walls are off straight lines by {:.2f} px: a lens that bends them, or rough "
                "walls; pictures of a board tell the lens",
                result.walls->residual_rms));
        }
    }
    const auto corners = result.walls ? result.walls->corner : given_corners(*options.corners);
    result.fit.camera =
        tracking::camera_of_rectangle(corners, options.sides->front(), options.sides->back(),
                                      options.unit, image.width(), image.height());
    require_order(corners, options.sides->front(), options.sides->back(), image, plan);
    if (result.walls) result.fit.camera.residual_rms = result.walls->residual_rms;
    return result;
}

/// Said before the work.
void require_free(const fs::path& output, const Job& job) {
    const OutputFile claimed(output, job.overwrite);
}

void warn_of(const CameraJobResult& result, RunPlan& plan) {
    const tracking::CameraFit& fit = result.fit;
    if (fit.reach < kFarReach) {
        plan.warn(
            fmt::format("the board reaches {:.0f} % of the way to the corners of the frame: "
                        "beyond it the lens is extrapolated",
                        100 * fit.reach));
    }
    if (fit.camera.residual_rms > kPoorFit) {
        plan.warn(
            fmt::format("the residual is {:.2f} px per axis: is the board flat, sharp and "
                        "at rest, and its grid square?",
                        fit.camera.residual_rms));
    }
    if (fit.dropped > 0) {
        plan.warn(fmt::format("{} did not fit and were left out", counted(fit.dropped, "point")));
    }
}

std::string not_found(BoardKind wanted, const BoardView& view) {
    std::string text = fmt::format("{} was looked for", name_of(wanted));
    if (view.spots > 0) {
        text += fmt::format("; it shows {} that lie on no common grid, as a frame of spheres does",
                            counted(static_cast<std::int64_t>(view.spots), "spot"));
    }
    return text;
}

/// Throws InputError for what only looks like a board.
void require_even(const CameraJobResult& result, const Place& place) {
    const double uneven = result.fit.camera.residual_rms / result.fit.pitch;
    if (uneven <= kMostUneven) return;
    throw InputError(
        {.problem = fmt::format("what {} shows is no even grid", place.name()),
         .actual = fmt::format("{} lie off it by {:.2f} px (RMS), {:.1f} % of their distance",
                               counted(static_cast<std::int64_t>(result.fit.residuals.size()),
                                       result.board == BoardKind::dots ? "dot" : "corner"),
                               result.fit.camera.residual_rms, 100 * uneven),
         .expected = fmt::format("{:g} % at most", 100 * kMostUneven),
         .suggestion = "use pictures of a flat board at rest, not a frame of the film; without a "
                       "board option 'walls' or option 'corners' tells the tilt"});
}

CameraJobResult of_boards(const CameraJobOptions& options, std::vector<Place> places, Job& job) {
    const std::size_t cell = thin_out(places, options);
    CameraJobResult result;
    result.board = options.board;
    result.pictures = static_cast<std::int64_t>(places.size());
    Progress progress("looking for boards", result.pictures, "pictures", job.verbosity);
    std::vector<BoardView> views;
    Image first;
    std::size_t cell_view = 0;
    // The picture that matters says what kind of board it is.
    std::vector<std::size_t> order{cell};
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i != cell) order.push_back(i);
    }
    for (const std::size_t i : order) {
        const Image image = image_of(places[i]);
        if (first.empty()) first = Image(image.width(), image.height());
        require_size(image, first, places[i]);
        BoardView view = look_for(image, options, result.board, job.threads);
        throw_if_interrupted("calibrate-camera");
        progress.advance();
        if (!view.empty()) {
            views.push_back(std::move(view));
            continue;
        }
        if (i == cell) {
            throw InputError(
                {.problem = fmt::format("no board in {}", places[i].name()),
                 .actual = not_found(options.board, view),
                 .expected = "3 x 3 inner corners of a chessboard, or a square grid that holds "
                             "half of the spots or more",
                 .suggestion = "it is the picture of the cell's plane: choose another with "
                               "option 'cell-picture', or name the inner corners of the board "
                               "with option 'inner-corners'; without a board option 'walls' or "
                               "option 'corners' tells the tilt"});
        }
        job.plan.warn(fmt::format("no board in {}: left out", places[i].name()));
    }
    progress.finish();
    result.views = static_cast<std::int64_t>(views.size());
    std::optional<tracking::PlaneScale> pitch;
    if (options.pitch) pitch = tracking::PlaneScale{*options.pitch, options.unit};
    result.fit = tracking::fit_camera(views, cell_view, first.width(), first.height(), pitch);
    job.plan.run(
        "lens",
        fmt::format("{} in {} of {}, {}; centre {}", name_of(result.board), result.views,
                    counted(result.pictures, "picture"),
                    counted(static_cast<std::int64_t>(result.fit.residuals.size()), "point"),
                    result.fit.is_centre_fitted ? "fitted" : "in the middle of the frame"));
    job.plan.run("tilt", fmt::format("the plane of the board in {}", places[cell].name()));
    require_even(result, places[cell]);
    warn_of(result, job.plan);
    return result;
}

}  // namespace

void describe(CameraJobOptions& options, OptionTable& table) {
    using tracking::PlaneUnit;
    table.choice("board", options.board,
                 {{"auto", BoardKind::automatic},
                  {"chessboard", BoardKind::chessboard},
                  {"dots", BoardKind::dots}},
                 "what the pictures show; auto: a chessboard, else a square grid of dots");
    table.integers("inner-corners", options.inner_corners, "-", {3, 1000},
                   "inner corners of the chessboard, as COLUMNS,ROWS; auto: as found", {2, 2});
    table.number("pitch", options.pitch, "", {1e-9, 1e9},
                 "distance of neighbouring corners or dots, in 'unit'; auto: the scale is not "
                 "known");
    table.choice("unit", options.unit, {{"mm", PlaneUnit::mm}, {"a", PlaneUnit::diameter}},
                 "of pitch and sides: mm, or diameters a of the spheres");
    table.integer("cell-picture", options.cell_picture, "-", {0, 1e9},
                  "picture whose board lies in the plane of the cell, or that shows the rectangle; "
                  "from 0 in the order given");
    table.integer("pictures", options.pictures, "-", {1, 10000},
                  "looked at, spread over those that are given");
    table.numbers("corners", options.corners, "px", {-1e6, 1e6},
                  "instead of a board: corners of a rectangle in the plane of the cell, in order "
                  "around it, as X,Y,X,Y,X,Y,X,Y",
                  {kCorners, kCorners});
    table.numbers("sides", options.sides, "", {1e-9, 1e9},
                  "with corners: from the first to the second corner, and from there to the "
                  "third, as W,H in 'unit'; with walls: level and upright side",
                  {2, 2});
    table.flag("walls", options.walls,
               "instead of a board: looks for the four walls of the cell in a frame of the film");
}

void plan_camera(const CameraJobOptions& options, Job& job) {
    job.inputs = io::recording_files(job.inputs);
    if (is_of_corners(options)) {
        job.plan.skip("lens", options.walls ? "walls tell no lens" : "corners are given",
                      "pictures of a board");
        const std::vector<Place> places = places_of(job);
        job.plan.run("tilt", fmt::format("the plane of the rectangle in {}; its sides are the "
                                         "walls of the cell",
                                         places[cell_picture(places, options)].name()));
        return;
    }
    std::vector<Place> places = places_of(job);
    const std::size_t cell = thin_out(places, options);
    job.plan.run("lens", fmt::format("{} in {}", name_of(options.board),
                                     counted(static_cast<std::int64_t>(places.size()), "picture")));
    job.plan.run("tilt", fmt::format("the plane of the board in {}", places[cell].name()));
}

CameraJobResult calibrate_camera(const CameraJobOptions& options, Job& job) {
    job.inputs = io::recording_files(job.inputs);
    CameraJobResult result;
    const fs::path picture = fs::path(options.output).replace_extension(".svg");
    require_free(options.output, job);
    if (is_of_corners(options)) {
        plan_camera(options, job);
        const std::vector<Place> places = places_of(job);
        result = of_rectangle(options, places[cell_picture(places, options)], job.plan);
    } else {
        require_free(picture, job);
        result = of_boards(options, places_of(job), job);
        write_file(picture, residual_picture(result.fit, 0), job.overwrite);
        result.picture = picture;
    }
    result.largest_shift = largest_shift(result.fit.camera);
    write_file(options.output, camera_file_text(result.fit.camera), job.overwrite);
    job.outputs.push_back(options.output);
    if (!result.picture.empty()) job.outputs.push_back(result.picture);
    return result;
}

}  // namespace grainfield::pipelines
