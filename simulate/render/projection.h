#pragma once

#include <optional>

#include "core/box.h"
#include "core/vec2.h"
#include "core/vec3.h"

namespace grainfield::simulate {

enum class Projection { perspective, telecentric };

/// Height of a cell that is not known [a]: that of the paper's experiment.
constexpr double default_cell_height = 1.94;

/// Where the camera stands and how large its frame is. Section `view`.
struct ViewOptions {
    int width = 1600;             ///< [px]
    int height = 1600;            ///< [px]
    std::optional<double> scale;  ///< pixels per diameter at mid height; auto: the box fills it
    Projection projection = Projection::perspective;
    double distance = 700;  ///< of the pinhole above mid height [a]; perspective only
    /// Half of the angle under which a point in focus, at mid height, sees the lens [rad].
    double aperture = 0;
    std::optional<double> centre_x;  ///< of the frame [a]; auto: centre of the box
    std::optional<double> centre_y;
    std::optional<double> cell_height;  ///< between the plates [a]; auto: of the trajectory
    double sphere_mm = 1;               ///< a in millimetres: joins simulated time to seconds
};

/// From the cell [a] to the frame [px]: a pinhole above the cell, or parallel rays.
///
///   x_px = o_x + s(z) (X − c_x),   y_px = o_y + s(z) (Y − c_y),
///   s(z) = s Z/(Z + z_0 − z)  (perspective),   s(z) = s  (telecentric)
///
/// s: pixels per diameter at the mid height z_0 of the cell; Z: distance of the pinhole above z_0;
/// c: point in the middle of the frame; o: that middle, ((W − 1)/2, (H − 1)/2) plus any shift.
/// The second axis of the cell points down in the frame (docs/conventions.md).
class View {
 public:
    /// `height`: of the cell [a]. Throws OptionError if the frame would be empty.
    View(const ViewOptions& options, const Box& box, double height);

    int width() const { return width_; }
    int height() const { return height_; }
    Projection projection() const { return projection_; }
    double scale() const { return scale_; }        ///< at mid height [px/a]
    double mid_height() const { return middle_; }  ///< z_0 [a]
    double distance() const { return distance_; }  ///< Z [a]
    Vec2 centre() const { return centre_; }        ///< c [a]
    double aperture() const { return aperture_; }  ///< half angle of the lens [rad]

    double scale_at(double z) const {
        return projection_ == Projection::telecentric
                   ? scale_
                   : scale_ * distance_ / (distance_ + middle_ - z);
    }
    Vec2 project(Vec3 p) const {
        const double s = scale_at(p.z);
        return {origin_.x + s * (p.x - centre_.x), origin_.y + s * (p.y - centre_.y)};
    }
    /// The point of the plane at height z that is seen at `pixel`; inverse of project.
    Vec3 at_height(Vec2 pixel, double z) const {
        const double s = scale_at(z);
        return {centre_.x + (pixel.x - origin_.x) / s, centre_.y + (pixel.y - origin_.y) / s, z};
    }

    /// The same view with `margin` more pixels on every side.
    View padded(int margin) const;
    /// The same view with every pixel cut into n × n.
    View refined(int n) const;
    /// The same view after everything moved by `shift` [px].
    View shifted(Vec2 shift) const;

 private:
    int width_;
    int height_;
    Projection projection_;
    double scale_;
    double middle_;
    double distance_;
    double aperture_;
    Vec2 centre_;
    Vec2 origin_;
};

}  // namespace grainfield::simulate
