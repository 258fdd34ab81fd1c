#include "tracking/synthesis/picture_information.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>

#include "core/support/parallel.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/synthesis/mirror_scene.h"

namespace grainfield::tracking {
namespace {

constexpr double kSeen = 3;  // [a] from a sphere that moves
// As known as nothing can be: of the information of the other coordinates.
constexpr double kNoTrace = 1e-9;

Point3 displaced(const Point3& p, const Point3& along, double length) {
    const auto q = static_cast<float>(length);
    return {p.x + q * along.x, p.y + q * along.y, p.z + q * along.z};
}

std::vector<Point3> displaced(std::vector<Point3> spheres, const SphereMotion& motion,
                              double length) {
    for (std::size_t i = 0; i < motion.sphere.size(); ++i) {
        Point3& p = spheres[static_cast<std::size_t>(motion.sphere[i])];
        p = displaced(p, motion.along[i], length);
    }
    return spheres;
}

void add(const ImagePatch& patch, float share, Image& image) {
    for (int v = 0; v < patch.height; ++v) {
        for (int u = 0; u < patch.width; ++u) {
            image(patch.x + u, patch.y + v) += share * patch.row(v)[u];
        }
    }
}

double product(const Image& a, const Image& b) {
    double sum = 0;
    for (int y = 0; y < a.height(); ++y) {
        const float* p = a.row(y);
        const float* q = b.row(y);
        float row = 0;
#pragma omp simd reduction(+ : row)
        for (int x = 0; x < a.width(); ++x) row += p[x] * q[x];
        sum += static_cast<double>(row);
    }
    return sum;
}

Image difference(const Image& a, const Image& b) {
    Image result = a;
    for (std::size_t k = 0; k < a.size(); ++k) result.pixels()[k] -= b.pixels()[k];
    return result;
}

/// Rows and columns of these coordinates.
Eigen::MatrixXd chosen(const PictureInformation& information,
                       const std::vector<std::size_t>& coordinates) {
    const auto n = static_cast<Eigen::Index>(coordinates.size());
    Eigen::MatrixXd matrix(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        for (Eigen::Index l = 0; l < n; ++l) {
            matrix(k, l) = information.information(coordinates[static_cast<std::size_t>(k)],
                                                   coordinates[static_cast<std::size_t>(l)]);
        }
    }
    return matrix;
}

}  // namespace

double anywhere_between(double cell_height) {
    return (cell_height - 1) / std::sqrt(12.0);
}

std::vector<SphereMotion> motions_of(const std::vector<std::int32_t>& spheres, double cell_height) {
    const double anywhere = anywhere_between(cell_height);
    std::vector<SphereMotion> motions;
    for (const std::int32_t i : spheres) {
        motions.push_back({.sphere = {i}, .along = {{1, 0, 0}}, .step = kPlaneStep});
        motions.push_back({.sphere = {i}, .along = {{0, 1, 0}}, .step = kPlaneStep});
        motions.push_back(
            {.sphere = {i}, .along = {{0, 0, 1}}, .step = kHeightStep, .known_to = anywhere});
    }
    return motions;
}

PictureInformation::PictureInformation(std::vector<Point3> spheres, const MirrorOptics& optics,
                                       const PictureSetting& setting,
                                       std::vector<SphereMotion> motions)
    : spheres_(std::move(spheres)),
      optics_(optics),
      setting_(setting),
      motions_(std::move(motions)),
      derivative_(motions_.size()),
      matrix_(motions_.size() * motions_.size()) {
    for (const SphereMotion& motion : motions_) {
        const bool is_there = std::ranges::all_of(motion.sphere, [&](std::int32_t i) {
            return i >= 0 && static_cast<std::size_t>(i) < spheres_.size();
        });
        if (!(motion.step > 0) || !is_there || motion.along.size() != motion.sphere.size()) {
            throw std::invalid_argument(
                "a motion has a step above 0, and one direction for each of its spheres");
        }
    }
    const MirrorScene scene(spheres_, optics_);
    MirrorImage image(setting_.width, setting_.height, setting_.scale, setting_.threads,
                      setting_.rays);
    image.render(scene);
    image_ = image.image();
    parallel_for(static_cast<std::int64_t>(size()), setting_.threads, [&](std::int64_t index) {
        const auto k = static_cast<std::size_t>(index);
        const SphereMotion& motion = motions_[k];
        derivative_[k] = Image(setting_.width, setting_.height);
        for (const double way : {motion.step, -motion.step}) {
            const auto share = static_cast<float>(0.5 / way);
            if (motion.sphere.size() == 1) {
                const Point3& here = spheres_[static_cast<std::size_t>(motion.sphere.front())];
                add(image.change(scene, motion.sphere.front(),
                                 displaced(here, motion.along.front(), way), kSeen),
                    share, derivative_[k]);
                continue;
            }
            const Image there = rendered(displaced(spheres_, motion, way));
            for (std::size_t pixel = 0; pixel < there.size(); ++pixel) {
                derivative_[k].pixels()[pixel] += share * there.pixels()[pixel];
            }
        }
    });
    parallel_for(static_cast<std::int64_t>(size()), setting_.threads, [&](std::int64_t index) {
        const auto k = static_cast<std::size_t>(index);
        for (std::size_t l = k; l < size(); ++l) {
            matrix_[k * size() + l] = matrix_[l * size() + k] =
                product(derivative_[k], derivative_[l]) / (setting_.noise * setting_.noise);
        }
    });
}

Image PictureInformation::rendered(const std::vector<Point3>& spheres) const {
    MirrorImage image(setting_.width, setting_.height, setting_.scale, 1, setting_.rays);
    image.render_only(MirrorScene(spheres, optics_));
    return image.image();
}

std::vector<double> PictureInformation::covariance(
    const std::vector<std::size_t>& coordinates) const {
    Eigen::MatrixXd matrix = chosen(*this, coordinates);
    for (Eigen::Index k = 0; k < matrix.rows(); ++k) {
        const double known = motions_[coordinates[static_cast<std::size_t>(k)]].known_to;
        matrix(k, k) += 1 / (known * known);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    const Eigen::VectorXd& value = solver.eigenvalues();
    if (value.size() > 0 && !(value(0) > kNoTrace * value(value.size() - 1))) {
        throw std::domain_error("the picture does not tell all of these coordinates");
    }
    const Eigen::MatrixXd inverse = solver.eigenvectors() * value.cwiseInverse().asDiagonal() *
                                    solver.eigenvectors().transpose();
    return {inverse.data(), inverse.data() + inverse.size()};
}

PictureInformation::Direction PictureInformation::weakest(
    const std::vector<std::size_t>& coordinates) const {
    if (coordinates.empty()) return {};
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(chosen(*this, coordinates));
    const Eigen::VectorXd& value = solver.eigenvalues();
    Direction weakest;
    weakest.error = value(0) > kNoTrace * value(value.size() - 1)
                        ? 1 / std::sqrt(value(0))
                        : std::numeric_limits<double>::infinity();
    const Eigen::VectorXd along = solver.eigenvectors().col(0);
    weakest.along.assign(along.data(), along.data() + along.size());
    return weakest;
}

double PictureInformation::told_from(const std::vector<Point3>& other,
                                     const std::vector<std::size_t>& coordinates) const {
    const Image left = difference(rendered(other), image_);
    const double squared = setting_.noise * setting_.noise;
    double sum = product(left, left) / squared;
    if (!coordinates.empty()) {
        Eigen::VectorXd gradient(static_cast<Eigen::Index>(coordinates.size()));
        for (Eigen::Index k = 0; k < gradient.size(); ++k) {
            gradient(k) =
                product(derivative_[coordinates[static_cast<std::size_t>(k)]], left) / squared;
        }
        const Eigen::MatrixXd matrix = chosen(*this, coordinates);
        sum -= gradient.dot(matrix.completeOrthogonalDecomposition().solve(gradient));
    }
    return std::sqrt(std::max(0.0, sum));
}

double PictureInformation::rms_from(const std::vector<Point3>& other) const {
    const Image left = difference(rendered(other), image_);
    return std::sqrt(product(left, left) / static_cast<double>(left.size()));
}

}  // namespace grainfield::tracking
