#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "tracking/model/image_model.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// What must be known of a film to tell its background from its spheres.
struct FilmLevels {
    double sign = 1;      ///< +1: spheres are darker than the background, −1: brighter
    double core = 0;      ///< in the core of a sphere [counts]
    double contrast = 1;  ///< clear less core, absolute [counts]
    double noise = 0;     ///< RMS from pixel to pixel [counts]
    double reach = 0;     ///< of an edge: 3.5 w [px]

    static FilmLevels of(const ImageModel& model, int width, int height);
};

/// What each pixel shows while no sphere is over it.
struct ClearLevels {
    Image level;  ///< [counts]; NaN: never clear in the frames looked at
    Image error;  ///< standard error [counts]
};

/// The clear level of every pixel from frames of a film in which spheres move.
///
/// Per pixel, with u = ±(I − I_core), the light above the core: of all u above half their 95 %
/// quantile (clear, however much the dirt at this pixel dims) the median, then the mean of those
/// within three standard deviations of the noise of it. Bias: edges of spheres are partly clear; in
/// layers of area fraction φ some φ/10 of the noise. A pixel whose quantile stays below 15 % of the
/// contrast is never clear: a sphere rests there, or it is blocked. Needs a pixel clear in more
/// than 5 % of the frames, 4 of 48. Two bytes a pixel and frame; about 0.4 µs a pixel for 48
/// frames.
class ClearLevelEstimator {
 public:
    ClearLevelEstimator(int width, int height) : width_(width), height_(height) {}

    /// Frames of the size given, counts in [0, 65535].
    void add(const Image& counts);
    int frames() const { return static_cast<int>(samples_.size()); }
    ClearLevels estimate(const FilmLevels& levels, int threads) const;

 private:
    int width_, height_;
    std::vector<std::vector<std::uint16_t>> samples_;
};

/// Makes the light that reaches the spheres as smooth as a polynomial can follow.
///
/// Light that dirt or a stain takes away at x is taken from all that is seen there:
///
///     I'(x) = I_core + g(x) [I(x) − I_core],   g = (S − I_core)/(B − I_core),
///
/// B the clear level and S the surface of degree 5 through the medians of its tiles, far ones left
/// aside. g is 1 where B is S to within 1 % of the contrast or four standard errors, and within the
/// reach of an edge of pixels that are never clear: they may be spheres at rest, which must not be
/// evened away. Pixels that are not visible are in no median and no share, and keep g = 1; a sphere
/// may rest there too. Where no tile is half known g is 1 everywhere.
struct Evening {
    Image gain;              ///< g [-]
    double uneven = 0;       ///< share of the visible pixels where g is not 1
    double never_clear = 0;  ///< share of the visible pixels
    double strongest = 0;    ///< largest |B − S| that was evened [contrast]
};
Evening evening_of(const ClearLevels& clear, const FilmLevels& levels,
                   const VisiblePixels& visible = {});

/// I' from I, in place.
void even_out(Image& counts, const Image& gain, const FilmLevels& levels, int threads = 1);

}  // namespace grainfield::tracking
