#include "simulate/render/projection.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::simulate {

View::View(const ViewOptions& options, const Box& box, double height)
    : width_(options.width),
      height_(options.height),
      projection_(options.projection),
      scale_(options.scale.value_or(
          std::min(options.width / box.length.x, options.height / box.length.y))),
      middle_(height / 2),
      distance_(options.distance),
      aperture_(options.aperture),
      centre_{options.centre_x.value_or(box.origin.x + box.length.x / 2),
              options.centre_y.value_or(box.origin.y + box.length.y / 2)},
      origin_{(options.width - 1) / 2.0, (options.height - 1) / 2.0} {
    if (width_ < 1 || height_ < 1 || !(scale_ > 0)) {
        throw OptionError({.problem = "view: an empty frame",
                           .actual = fmt::format("{} × {} pixels, {:g} pixels per diameter", width_,
                                                 height_, scale_),
                           .expected = "positive numbers",
                           .suggestion = {}});
    }
}

View View::padded(int margin) const {
    View view = *this;
    view.width_ += 2 * margin;
    view.height_ += 2 * margin;
    view.origin_ += {static_cast<double>(margin), static_cast<double>(margin)};
    return view;
}

View View::refined(int n) const {
    View view = *this;
    view.width_ *= n;
    view.height_ *= n;
    view.scale_ *= n;
    view.origin_ = {(origin_.x + 0.5) * n - 0.5, (origin_.y + 0.5) * n - 0.5};
    return view;
}

View View::shifted(Vec2 shift) const {
    View view = *this;
    view.origin_ += shift;
    return view;
}

}  // namespace grainfield::simulate
