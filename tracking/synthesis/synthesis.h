#pragma once

#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/vec2.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/error_scale.h"
#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

struct SynthesisOptions {
    double height = 1.94;  ///< of the cell [a]
    int searches = 1;      ///< most rounds of the search for other arrangements, 0: none
};

/// Without the height, which is an option of the layers.
OptionTable describe(SynthesisOptions& options);

/// Spheres in space and how they are lit. z is 0 where a centre touches bottom.
struct SynthesisStart {
    std::vector<Vec2> position;  ///< [px]
    std::vector<double> z;       ///< [a]; empty: unknown
    MirrorOptics optics;
    OpticsErrors optics_error = {};              ///< of optics that are known
    bool are_optics_known = false;               ///< else estimated from the frame
    std::optional<ErrorScale> error_scale = {};  ///< empty: learned
};

struct Synthesis {
    std::vector<Vec2> position;    ///< [px]
    std::vector<double> z;         ///< height of each centre above the lowest place [a]
    std::vector<Vec2> error;       ///< standard errors [px]
    std::vector<double> z_error;   ///< [a]
    std::vector<double> residual;  ///< local RMS of image − rendering [contrast]
    MirrorOptics optics;
    OpticsErrors optics_error;
    ErrorScale error_scale;      ///< that errors hold
    double residual_before = 0;  ///< RMS of image − rendering at the start [contrast]
    double residual_rms = 0;     ///< … at the end
    double unexplained = 0;      ///< of it what neighbouring pixels share: no noise
    int rounds = 0;              ///< Gauss–Newton rounds
    int trials = 0;              ///< other arrangements tried
    int added = 0, removed = 0, lifted = 0;
    int doubtful = 0;    ///< spheres a diameter or more within the frame about which image and
                         ///< rendering still differ unusually: the way from their disc is in the
                         ///< error, their heights count as unknown
    Image residual_map;  ///< image − rendering [contrast]
};

/// Positions and heights of mirror-like spheres from one frame by analysis and synthesis.
///
/// The spheres found, x and y, are rendered as mirrors over a panel (MirrorScene); optics and light
/// are fitted to the frame; then x, y and z of all spheres by Gauss–Newton on the rendered image
/// (SynthesisFit), and where image and rendering still differ other arrangements are tried
/// (improve_arrangement). `diameter`: true diameter a [px]. `model`: what the calibration says of
/// background and dark level. `start.position` should hold every sphere seen, those cut by the
/// border too. Positions come back in another order. Errors are those of all spheres
/// together under the residual that is left (sphere_errors).
/// Same bits for any number of threads. Memory: 40 bytes a ray, 450 MB at 1600² px.
Synthesis synthesise(const Image& counts, const ImageModel& model, double diameter,
                     const SynthesisStart& start, const SynthesisOptions& options, int threads);

}  // namespace grainfield::tracking
