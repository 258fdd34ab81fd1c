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
constexpr int kLight = 2;  // and what each square's light takes
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
constexpr double kBlock = 1.5;        // [a] residuals farther apart are taken as independent
constexpr std::size_t kLeastBlocks = 9;

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

/// What a part of the frame says of the optics: A δ = b.
struct OpticsEquations {
    OpticsMatrix a = OpticsMatrix::Zero();
    OpticsVector b = OpticsVector::Zero();
};

/// What one square says, block by block, whatever its light is.
std::vector<OpticsEquations> equations_of(const OpticsSquare& square, MirrorOptics optics,
                                          double scale, int threads) {
    constexpr int kTerms = kOpticsTerms + kLight;
    struct Block {
        Eigen::Matrix<double, kTerms, kTerms> a = Eigen::Matrix<double, kTerms, kTerms>::Zero();
        Eigen::Matrix<double, kTerms, 1> b = Eigen::Matrix<double, kTerms, 1>::Zero();
    };
    optics.middle_x -= square.corner_x;
    optics.middle_y -= square.corner_y;
    const int width = square.brightness.width();
    const int height = square.brightness.height();
    const MirrorImage rendering(width, height, scale, threads);
    std::vector<MirrorOptics> varied(kOpticsTerms + 1, optics);  // the last one as it is
    for (int t = 0; t < kOpticsTerms; ++t) {
        term_of(varied[static_cast<std::size_t>(t)], t) += kOpticsStep[t];
    }
    std::vector<Image> by = rendering.renderings(MirrorScene(square.spheres, optics), varied);
    const Image base = std::move(by.back());
    const int border = static_cast<int>(std::ceil(scale));
    const FrameLight light = fit_light(square.brightness, square.ceiling, base, border);
    const Image left = light_residual(square.brightness, square.ceiling, base, light, threads);
    for (int t = 0; t < kOpticsTerms; ++t) {
        Image& difference = by[static_cast<std::size_t>(t)];
        for (std::size_t k = 0; k < difference.size(); ++k) {
            difference.pixels()[k] = (difference.pixels()[k] - base.pixels()[k]) *
                                     static_cast<float>(light.gain / kOpticsStep[t]);
        }
    }
    const int side = std::max(1, static_cast<int>(std::lround(kBlock * scale)));
    const int columns = std::max(1, (width - 2 * border) / side);
    const int rows = std::max(1, (height - 2 * border) / side);
    const auto per_row = static_cast<std::size_t>(columns);
    std::vector<Block> blocks(per_row * static_cast<std::size_t>(rows));
    Block whole;
    for (int y = border; y < height - border; ++y) {
        const int row = std::min((y - border) / side, rows - 1);
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
            const int column = std::min((x - border) / side, columns - 1);
            Block& block =
                blocks[static_cast<std::size_t>(row) * per_row + static_cast<std::size_t>(column)];
            block.a += j * j.transpose();
            block.b += r * j;
        }
    }
    for (const Block& block : blocks) whole.a += block.a;
    Eigen::Matrix2d of_light = whole.a.bottomRightCorner<kLight, kLight>();
    of_light.diagonal().array() += 1e-6;
    const Eigen::Matrix<double, kOpticsTerms, kLight> shared =
        whole.a.topRightCorner<kOpticsTerms, kLight>() * of_light.inverse();
    std::vector<OpticsEquations> equations;
    for (const Block& block : blocks) {
        if (block.a.isZero()) continue;
        equations.push_back({block.a.topLeftCorner<kOpticsTerms, kOpticsTerms>() -
                                 shared * block.a.bottomLeftCorner<kLight, kOpticsTerms>(),
                             block.b.head<kOpticsTerms>() - shared * block.b.tail<kLight>()});
    }
    return equations;
}

/// Standard errors after `step`, which solves A δ = Σ b but for what limits took from it.
OpticsVector errors_of(const std::vector<OpticsEquations>& blocks, std::size_t squares,
                       const OpticsMatrix& a, const OpticsVector& step) {
    OpticsMatrix scores = OpticsMatrix::Zero();
    for (const OpticsEquations& block : blocks) {
        const OpticsVector score = block.b - block.a * step;
        scores += score * score.transpose();
    }
    const auto n = static_cast<double>(blocks.size());
    const auto fitted = static_cast<double>(kOpticsTerms + kLight * squares);
    const OpticsMatrix inverse = a.inverse();
    const OpticsMatrix covariance = inverse * scores * inverse * (n / (n - fitted));
    return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

}  // namespace

FittedOptics fitted_optics(const OpticsFrame& frame, const std::vector<Point3>& spheres,
                           MirrorOptics optics, int threads) {
    const std::vector<OpticsSquare> squares = optics_squares(frame, spheres);
    OpticsErrors error;
    for (int round = 0; round < kOpticsRounds; ++round) {
        std::vector<OpticsEquations> blocks;
        for (const OpticsSquare& square : squares) {
            const std::vector<OpticsEquations> here =
                equations_of(square, optics, frame.scale, threads);
            blocks.insert(blocks.end(), here.begin(), here.end());
        }
        OpticsEquations whole;
        for (const OpticsEquations& block : blocks) {
            whole.a += block.a;
            whole.b += block.b;
        }
        whole.a.diagonal() *= 1 + 1e-6;
        whole.a.diagonal().array() += 1e-6;
        const OpticsVector step = whole.a.ldlt().solve(whole.b);
        for (int t = 0; t < kOpticsTerms; ++t) {
            double& term = term_of(optics, t);
            term =
                std::clamp(term + std::clamp(step(t), -0.2, 0.2), kOpticsLeast[t], kOpticsMost[t]);
        }
        if (blocks.size() < kLeastBlocks * squares.size()) continue;
        const OpticsVector errors = errors_of(blocks, squares.size(), whole.a, step);
        error = {errors(0), errors(1), errors(2), errors(3)};
    }
    return {optics, error};
}

}  // namespace grainfield::tracking
