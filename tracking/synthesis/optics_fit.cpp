#include "tracking/synthesis/optics_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Dense>

#include "core/image_part.h"
#include "tracking/synthesis/frame_light.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/synthesis/mirror_scene.h"

namespace grainfield::tracking {
namespace {

/// The optics as a vector of what is fitted, and the steps of differences.
constexpr int kOpticsTerms = 4;
double& term_of(MirrorOptics& optics, int term) {
    double* terms[kOpticsTerms] = {&optics.reflectivity, &optics.blur, &optics.ambient,
                                   &optics.grazing};
    return *terms[term];
}
constexpr double kOpticsStep[kOpticsTerms] = {0.02, 0.004, 0.02, 0.02};
constexpr double kOpticsLeast[kOpticsTerms] = {0.1, 0.01, 0, 0};
constexpr double kOpticsMost[kOpticsTerms] = {0.98, 0.4, 0.6, 0.7};
constexpr int kOpticsRounds = 2;
// Optics are fitted on so many squares along each side, or on one in the middle of a frame that
// they would cover.
constexpr int kOpticsSquares = 3;
constexpr double kOpticsSide = 7;     // [a]
constexpr double kOpticsMiddle = 16;  // [a]

using OpticsMatrix = Eigen::Matrix<double, kOpticsTerms, kOpticsTerms>;
using OpticsVector = Eigen::Matrix<double, kOpticsTerms, 1>;

/// A part of the frame, and the spheres that are seen in it, with its corner as origin [a].
struct OpticsSquare {
    Image brightness, ceiling;
    std::vector<Point3> spheres;
    double corner_x, corner_y;  ///< [a]
};

OpticsSquare cut_square(const Image& brightness, const Image& ceiling,
                        const std::vector<Point3>& spheres, double scale, int x0, int y0, int width,
                        int height) {
    constexpr float kMirrored = 10;  // [a] beyond the square, as far as a ray is followed
    OpticsSquare square{part_of(brightness, x0, y0, width, height),
                        part_of(ceiling, x0, y0, width, height),
                        {},
                        x0 / scale,
                        y0 / scale};
    const auto shift_x = static_cast<float>(square.corner_x);
    const auto shift_y = static_cast<float>(square.corner_y);
    const auto right = static_cast<float>(width / scale) + kMirrored;
    const auto bottom = static_cast<float>(height / scale) + kMirrored;
    for (const Point3& p : spheres) {
        const Point3 here{p.x - shift_x, p.y - shift_y, p.z};
        if (here.x < -kMirrored || here.y < -kMirrored || here.x > right || here.y > bottom) {
            continue;
        }
        square.spheres.push_back(here);
    }
    return square;
}

std::vector<OpticsSquare> optics_squares(const OpticsFrame& frame,
                                         const std::vector<Point3>& spheres) {
    const Image& brightness = frame.brightness;
    const Image& ceiling = frame.ceiling;
    const double scale = frame.scale;
    const auto side_of = [&](double most, int along) {
        return std::min(static_cast<int>(most * scale), along);
    };
    const bool are_many = std::min(brightness.width(), brightness.height()) >
                          kOpticsSquares * static_cast<int>(kOpticsSide * scale);
    const int per_side = are_many ? kOpticsSquares : 1;
    const double most = are_many ? kOpticsSide : kOpticsMiddle;
    const int width = side_of(most, brightness.width());
    const int height = side_of(most, brightness.height());
    std::vector<OpticsSquare> squares;
    for (int v = 0; v < per_side; ++v) {
        for (int u = 0; u < per_side; ++u) {
            squares.push_back(cut_square(
                brightness, ceiling, spheres, scale,
                (2 * u + 1) * brightness.width() / (2 * per_side) - width / 2,
                (2 * v + 1) * brightness.height() / (2 * per_side) - height / 2, width, height));
        }
    }
    return squares;
}

/// Adds what one square says of the optics, whatever its light is.
void add_square(const OpticsSquare& square, MirrorOptics optics, double scale, int threads,
                OpticsMatrix& a, OpticsVector& b) {
    constexpr int kLight = 2;
    optics.middle_x -= square.corner_x;
    optics.middle_y -= square.corner_y;
    const int width = square.brightness.width();
    const int height = square.brightness.height();
    MirrorImage rendering(width, height, scale, threads);
    const auto image_with = [&](const MirrorOptics& with) {
        rendering.render_only(MirrorScene(square.spheres, with));
        return rendering.image();
    };
    const int border = static_cast<int>(std::ceil(scale));
    const Image base = image_with(optics);
    const FrameLight light = fit_light(square.brightness, square.ceiling, base, border);
    const Image left = light_residual(square.brightness, square.ceiling, base, light, threads);
    std::vector<Image> by;
    for (int t = 0; t < kOpticsTerms; ++t) {
        MirrorOptics other = optics;
        term_of(other, t) += kOpticsStep[t];
        Image difference = image_with(other);
        for (std::size_t k = 0; k < difference.size(); ++k) {
            difference.pixels()[k] = (difference.pixels()[k] - base.pixels()[k]) *
                                     static_cast<float>(light.gain / kOpticsStep[t]);
        }
        by.push_back(std::move(difference));
    }
    constexpr int kTerms = kOpticsTerms + kLight;
    Eigen::Matrix<double, kTerms, kTerms> whole = decltype(whole)::Zero();
    Eigen::Matrix<double, kTerms, 1> right = decltype(right)::Zero();
    for (int y = border; y < height - border; ++y) {
        for (int x = border; x < width - border; ++x) {
            const auto r = static_cast<double>(left(x, y));
            if (std::abs(r) > kUnexplained * light.gain) continue;
            if (square.brightness(x, y) >= square.ceiling(x, y)) continue;
            Eigen::Matrix<double, kTerms, 1> j;
            for (int t = 0; t < kOpticsTerms; ++t) {
                j(t) = static_cast<double>(by[static_cast<std::size_t>(t)](x, y));
            }
            j(kOpticsTerms) = static_cast<double>(base(x, y));
            j(kOpticsTerms + 1) = 1;
            whole += j * j.transpose();
            right += r * j;
        }
    }
    Eigen::Matrix2d of_light = whole.bottomRightCorner<kLight, kLight>();
    of_light.diagonal().array() += 1e-6;
    const Eigen::Matrix<double, kOpticsTerms, kLight> shared =
        whole.topRightCorner<kOpticsTerms, kLight>() * of_light.inverse();
    a += whole.topLeftCorner<kOpticsTerms, kOpticsTerms>() -
         shared * whole.bottomLeftCorner<kLight, kOpticsTerms>();
    b += right.head<kOpticsTerms>() - shared * right.tail<kLight>();
}

}  // namespace

MirrorOptics fitted_optics(const OpticsFrame& frame, const std::vector<Point3>& spheres,
                           MirrorOptics optics, int threads) {
    const std::vector<OpticsSquare> squares = optics_squares(frame, spheres);
    for (int round = 0; round < kOpticsRounds; ++round) {
        OpticsMatrix a = OpticsMatrix::Zero();
        OpticsVector b = OpticsVector::Zero();
        for (const OpticsSquare& square : squares) {
            add_square(square, optics, frame.scale, threads, a, b);
        }
        a.diagonal() *= 1 + 1e-6;
        a.diagonal().array() += 1e-6;
        const OpticsVector step = a.ldlt().solve(b);
        for (int t = 0; t < kOpticsTerms; ++t) {
            double& term = term_of(optics, t);
            term =
                std::clamp(term + std::clamp(step(t), -0.2, 0.2), kOpticsLeast[t], kOpticsMost[t]);
        }
    }
    return optics;
}

}  // namespace grainfield::tracking
