#pragma once

#include <filesystem>

#include "core/results.h"
#include "core/support/output_file.h"
#include "core/trajectory.h"

namespace grainfield::io {

/// How many digits a position has.
enum class Digits {
    as_errors,  ///< the last one is at most a tenth of the standard error; all where that is
                ///< unknown
    all         ///< the shortest text that reads back to the same double
};

struct PointsForm {
    bool header = false;  ///< units and box as comment lines before the table, not in a file beside
    Digits digits = Digits::as_errors;
};

/// Writes the table `frame,particle,x,y,z,x_std,y_std,z_std,layer,quality`, one particle a line.
/// Columns that no frame has are left out, missing numbers are empty. Beside it, in
/// `statement_path(path)`, comment lines state the units, the particle diameter, the frame rate and
/// the box (PointsStatement; not a box that changes with time), times that are not frame / frame
/// rate, and frames without particles. With `header` they stand in the table itself. With
/// `Digits::as_errors` standard errors have three digits and qualities four. Reads the source three
/// times. Throws OutputError (see OutputFile).
void export_csv(SnapshotSource& source, const std::filesystem::path& path, Overwrite overwrite,
                const PointsForm& form = {});

/// Writes extended XYZ, one block a frame: number of particles; Lattice, Origin, pbc, frame, Time
/// and Properties; species, position, radius (half the particle diameter) and where they apply id,
/// velocity, position_error (of x, y, z), layer and quality. Reads the source twice. Throws
/// OutputError.
void export_xyz(SnapshotSource& source, const std::filesystem::path& path, Overwrite overwrite,
                Digits digits = Digits::as_errors);

/// Writes one CSV per curve into `folder`, which is made if it is missing: header = column names,
/// first column, then text columns, then the others; and `units.csv` (curve, column, unit,
/// meaning), which says what their columns are. Nothing is written if one of the files exists and
/// Overwrite is refuse. Throws OutputError, and InputError for curve names that are not plain file
/// names or occur twice.
void export_curves(const Results& results, const std::filesystem::path& folder,
                   Overwrite overwrite);

}  // namespace grainfield::io
