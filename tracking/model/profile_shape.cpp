#include "tracking/model/profile_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grainfield::tracking {
namespace {

constexpr double kStep = 1e-3;          // [w] of the differences
constexpr int kIntervalsPerWidth = 64;  // of the sum

}  // namespace

double ProfileShape::slope(double r, double diameter, double edge_width) const {
    const double h = kStep * edge_width;
    return (darkness(r - h, diameter, edge_width) - darkness(r + h, diameter, edge_width)) /
           (2 * h);
}

SizeDerivatives ProfileShape::size_derivatives(double r, double diameter, double edge_width,
                                               double scale) const {
    const double h = kStep * edge_width;
    const double share = scale / (2 * h);
    return {
        share * (darkness(r, diameter + h, edge_width) - darkness(r, diameter - h, edge_width)),
        share * (darkness(r, diameter, edge_width + h) - darkness(r, diameter, edge_width - h))};
}

double ProfileShape::information(double diameter, double edge_width) const {
    const double step = edge_width / kIntervalsPerWidth;
    const double width = reach_in_widths() * edge_width;
    const double last = diameter / 2 + width;
    double sum = 0;
    for (double r = std::max(0.0, diameter / 2 - width); r <= last; r += step) {
        const double s = slope(r, diameter, edge_width);
        sum += s * s * r;
    }
    return std::numbers::pi * sum * step;
}

}  // namespace grainfield::tracking
