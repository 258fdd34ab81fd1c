#include "core/box.h"

#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

double shortest_image(double d, double length) {
    const double half = length / 2;
    if (std::abs(d) <= half) return d;
    // Exact by Sterbenz' lemma; `remainder` is exact for any argument, but slower.
    if (std::abs(d) <= 1.5 * length) return d > 0 ? d - length : d + length;
    return std::remainder(d, length);
}

double fold(double p, double origin, double length) {
    double offset = std::fmod(p - origin, length);
    if (offset < 0) offset += length;
    const double folded = origin + offset;
    return folded < origin + length ? folded : origin;
}

void require_positive(double length, char axis) {
    if (std::isfinite(length) && length > 0) return;
    throw OptionError({.problem = fmt::format("box length along {} is not usable", axis),
                       .actual = fmt::format("{}", length),
                       .expected = "a finite positive length",
                       .suggestion = {}});
}

}  // namespace

bool Box::contains(Vec2 p) const {
    return p.x >= origin.x && p.x < origin.x + length.x && p.y >= origin.y &&
           p.y < origin.y + length.y;
}

Vec2 Box::minimum_image(Vec2 d) const {
    if (boundary[0] == Boundary::periodic) d.x = shortest_image(d.x, length.x);
    if (boundary[1] == Boundary::periodic) d.y = shortest_image(d.y, length.y);
    return d;
}

Vec2 Box::wrap(Vec2 p) const {
    if (boundary[0] == Boundary::periodic) p.x = fold(p.x, origin.x, length.x);
    if (boundary[1] == Boundary::periodic) p.y = fold(p.y, origin.y, length.y);
    return p;
}

void require_valid(const Box& box) {
    require_positive(box.length.x, 'x');
    require_positive(box.length.y, 'y');
    if (!is_finite(box.origin)) {
        throw OptionError({.problem = "box origin is not usable",
                           .actual = fmt::format("({}, {})", box.origin.x, box.origin.y),
                           .expected = "finite coordinates",
                           .suggestion = {}});
    }
    if (!std::isfinite(box.height) || box.height < 0) {
        throw OptionError({.problem = "box height is not usable",
                           .actual = fmt::format("{}", box.height),
                           .expected = "0 (unknown) or a finite positive distance",
                           .suggestion = {}});
    }
}

}  // namespace grainfield
