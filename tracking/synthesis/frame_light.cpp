#include "tracking/synthesis/frame_light.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/support/parallel.h"

namespace grainfield::tracking {

double from_middle(const Image& frame, int x, int y) {
    const double u = x - 0.5 * (frame.width() - 1);
    const double v = y - 0.5 * (frame.height() - 1);
    const double half = 0.25 * (static_cast<double>(frame.width()) * frame.width() +
                                static_cast<double>(frame.height()) * frame.height());
    return (u * u + v * v) / half;
}

FrameLight fit_light(const Image& brightness, const Image& ceiling, const Image& radiance,
                     int border) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (int y = border; y < brightness.height() - border; ++y) {
        for (int x = border; x < brightness.width() - border; ++x) {
            if (brightness(x, y) >= ceiling(x, y)) continue;
            const auto m = static_cast<double>(radiance(x, y));
            const Eigen::Vector3d term(1, m, m * from_middle(brightness, x, y));
            a += term * term.transpose();
            b += static_cast<double>(brightness(x, y)) * term;
        }
    }
    a.diagonal().array() += 1e-9;
    const Eigen::Vector3d light = a.ldlt().solve(b);
    return {light(0), light(1), light(2)};
}

Image light_residual(const Image& brightness, const Image& ceiling, const Image& radiance,
                     const FrameLight& light, int threads) {
    Image residual(brightness.width(), brightness.height());
    parallel_for(brightness.height(), threads, [&](std::int64_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < brightness.width(); ++x) {
            const double model =
                light(static_cast<double>(radiance(x, y)), from_middle(brightness, x, y));
            const bool is_clipped =
                brightness(x, y) >= ceiling(x, y) && model >= static_cast<double>(ceiling(x, y));
            residual(x, y) =
                is_clipped ? 0.0F
                           : static_cast<float>(static_cast<double>(brightness(x, y)) - model);
        }
    });
    return residual;
}

double inner_rms(const Image& image, int border) {
    double squares = 0;
    double n = 0;
    for (int y = border; y < image.height() - border; ++y) {
        for (int x = border; x < image.width() - border; ++x) {
            squares += static_cast<double>(image(x, y)) * static_cast<double>(image(x, y));
            n += 1;
        }
    }
    return n > 0 ? std::sqrt(squares / n) : 0;
}

}  // namespace grainfield::tracking
