#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.h"
#include "pipelines/job.h"
#include "tracking/camera/camera_fit.h"
#include "tracking/camera/wall_lines.h"

namespace grainfield::pipelines {

/// What the pictures show.
enum class BoardKind { automatic, chessboard, dots };

/// What the calibration of a camera is asked for; the pictures are the inputs of the job.
struct CameraJobOptions {
    std::filesystem::path output;
    BoardKind board = BoardKind::automatic;
    std::vector<std::int64_t> inner_corners;  ///< columns, rows; empty: as found
    std::optional<double> pitch;              ///< distance of neighbours [unit]; empty: no scale
    tracking::PlaneUnit unit = tracking::PlaneUnit::mm;
    std::int64_t cell_picture = 0;  ///< its board lies in the plane of the cell, or its rectangle
    std::int64_t pictures = 40;     ///< looked at, spread evenly
    std::optional<std::vector<double>> corners;  ///< x,y of four, in the picture of the cell [px]
    std::optional<std::vector<double>> sides;    ///< of that rectangle [unit]
    bool walls = false;                          ///< the rectangle is looked for in the picture
};

void describe(CameraJobOptions& options, OptionTable& table);

struct CameraJobResult {
    tracking::CameraFit fit;
    BoardKind board = BoardKind::automatic;
    std::int64_t pictures = 0, views = 0;      ///< looked at, with a board
    std::optional<tracking::CellWalls> walls;  ///< where they were looked for
    double largest_shift = 0;                  ///< of the correction over the frame [px]
    std::filesystem::path picture;             ///< of the residuals; empty: of a rectangle
};

/// Says in the plan what calibrate_camera would do. Throws OptionError.
void plan_camera(const CameraJobOptions& options, Job& job);

/// Lens and tilt from pictures of a board (tracking::fit_camera), or tilt alone from the corners of
/// a rectangle (tracking::camera_of_rectangle), given or those of the walls that are seen
/// (tracking::find_walls). Writes the camera file, and of a board a picture
/// of the residuals beside it. Pictures without a board are left out with a warning. Sides that
/// only the other order explains are refused (tracking::rectangle_view). Throws OptionError;
/// InputError for pictures of different sizes, and where no board is found, or none in the picture
/// of the cell's plane.
CameraJobResult calibrate_camera(const CameraJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
