#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/box.h"
#include "core/frame.h"
#include "core/snapshot.h"
#include "core/vec2.h"

namespace grainfield::tracking {

/// Radial and tangential distortion of a lens, as OpenCV has it. With x = (u − centre)/focal, u
/// where an ideal lens would have a point,
///
///   x_d = x (1 + k1 r² + k2 r⁴) + 2 p1 x y + p2 (r² + 2 x²),
///   y_d = y (1 + k1 r² + k2 r⁴) + p1 (r² + 2 y²) + 2 p2 x y,     r² = x² + y².
struct Lens {
    double focal = 1;  ///< [px]
    Vec2 centre;       ///< [px]
    double k1 = 0, k2 = 0, p1 = 0, p2 = 0;

    bool is_straight() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0; }
    bool operator==(const Lens&) const = default;
};

/// What lengths in the plane of the cell are measured in.
enum class PlaneUnit { mm, diameter };

/// One corrected pixel in the plane of the cell.
struct PlaneScale {
    double length = 1;
    PlaneUnit unit = PlaneUnit::mm;

    bool operator==(const PlaneScale&) const = default;
};

/// How a camera sees the plane of a cell: picture → without distortion → corrected pixels.
///
/// Corrected pixels are those of an ideal camera that looks straight down on the plane. In the
/// middle of the frame they are as large as those of the picture, so that diameters hold there.
struct Camera {
    int width = 0, height = 0;                                    ///< of whole frames [px]
    Lens lens;                                                    ///< [px]
    std::array<double, 9> homography{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< undistorted → corrected px
    std::optional<PlaneScale> scale = {};                         ///< empty: not known
    std::optional<Box> cell = {};  ///< its walls, where they are known [corrected px]
    double residual_rms = 0;       ///< per axis, of the points it was made of [px]

    bool operator==(const Camera&) const = default;

    /// Throws InputError, with both sizes, for frames of another size.
    void require_size(int other_width, int other_height, const std::string& film) const;
    /// True diameter of spheres of that many mm [corrected px]; 1 a where the scale is in a. Empty:
    /// the camera does not know.
    std::optional<double> diameter_px(const std::optional<double>& sphere_mm) const;
};

/// Why positions cannot be corrected with it, in words; empty if they can. Over the whole frame the
/// picture must not fold over, and areas may change by a factor of 25 at most.
std::string fault_of(const Camera& camera);

/// Maps positions of the picture to corrected ones and back.
class CameraMap {
 public:
    /// `origin`: first pixel of a region; positions and results then count from it. Throws
    /// InputError where fault_of() says why.
    explicit CameraMap(const Camera& camera, Vec2 origin = {});

    /// ∂(corrected)/∂(picture).
    struct Jacobian {
        double xx = 1, xy = 0, yx = 0, yy = 1;
        double determinant() const { return xx * yy - xy * yx; }
    };
    struct Corrected {
        Vec2 position;
        Jacobian jacobian;
    };
    /// Newton's iteration to 1e-10 px; about 0.6 µs. NaN where no point of the plane is seen at p,
    /// which can only be outside of the frame.
    Corrected corrected(Vec2 p) const;
    /// The same of a camera that is still being made: no fault is looked for.
    static Corrected unchecked(const Camera& camera, Vec2 p);
    /// Where the picture has it; closed form.
    Vec2 in_picture(Vec2 corrected) const;

    /// Corrects positions and their standard errors: σ_x'² = J_xx² σ_x² + J_xy² σ_y², the
    /// covariance of x and y taken as zero. All other columns stay.
    void correct(Snapshot& snapshot) const;

    /// The rectangle that analysis takes for the cell, for frames of that size: the cell's own
    /// walls where these are known and seen, else the rectangle of which all was seen, bounded by
    /// the innermost points of the frame's corrected sides. Throws InputError if there is none.
    Box box(int width, int height) const;

    const Camera& camera() const { return camera_; }

 private:
    Camera camera_;
    std::array<double, 9> back_;  ///< inverse of the homography
    Vec2 origin_;
};

/// Pictures as the ideal camera has them, by linear interpolation: for people, not for
/// measurements. Of the size of the frame; what was not seen has the value of the nearest border.
class CorrectedPictures {
 public:
    CorrectedPictures(const CameraMap& map, int width, int height);
    Image operator()(const Image& frame) const;

 private:
    Image x_, y_;  ///< where each pixel is in the frame
};

/// Every number of it, to tell cameras apart.
std::vector<double> numbers_of(const Camera& camera);

}  // namespace grainfield::tracking
