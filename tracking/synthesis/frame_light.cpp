#include "tracking/synthesis/frame_light.h"

#include <algorithm>
#include <array>
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

namespace {

constexpr double kUnexplained = 0.15;  // [contrast] belongs to a wrong arrangement
constexpr double kStiffness = 1e-4;    // of nodes: of the pixels about one
constexpr double kLeastGain = 0.5;     // of the mean
constexpr std::size_t kFields = 3;     // offset, gain, sharpness

/// Nodes over an image, and what each of the four about a pixel weighs there.
class Nodes {
 public:
    Nodes(const Image& image, double spacing)
        : columns_(along(image.width(), spacing)),
          rows_(along(image.height(), spacing)),
          step_x_((image.width() - 1.0) / (columns_ - 1)),
          step_y_((image.height() - 1.0) / (rows_ - 1)) {}

    Eigen::Index count() const { return static_cast<Eigen::Index>(columns_) * rows_; }

    struct Share {
        std::array<Eigen::Index, 4> node;
        std::array<double, 4> weight;
    };
    Share at(int x, int y) const {
        const int u = std::min(static_cast<int>(x / step_x_), columns_ - 2);
        const int v = std::min(static_cast<int>(y / step_y_), rows_ - 2);
        const double a = x / step_x_ - u;
        const double b = y / step_y_ - v;
        const Eigen::Index first = static_cast<Eigen::Index>(v) * columns_ + u;
        return {{first, first + 1, first + columns_, first + columns_ + 1},
                {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
    }

    template <class Action>
    void each_pair(Action&& action) const {
        for (int v = 0; v < rows_; ++v) {
            for (int u = 0; u < columns_; ++u) {
                const Eigen::Index i = static_cast<Eigen::Index>(v) * columns_ + u;
                if (u + 1 < columns_) action(i, i + 1);
                if (v + 1 < rows_) action(i, i + columns_);
            }
        }
    }

 private:
    static int along(int size, double spacing) {
        return 1 + std::max(1, static_cast<int>(std::lround(size / spacing)));
    }
    int columns_, rows_;
    double step_x_, step_y_;
};

/// ∇² by differences of neighbouring pixels; the border goes on beyond itself.
double laplacian(const Image& image, int x, int y) {
    const int left = std::max(0, x - 1);
    const int right = std::min(image.width() - 1, x + 1);
    const int up = std::max(0, y - 1);
    const int down = std::min(image.height() - 1, y + 1);
    return static_cast<double>(image(left, y) + image(right, y) + image(x, up) + image(x, down) -
                               4 * image(x, y));
}

/// What o, g and c are multiplied by at a pixel.
std::array<double, kFields> terms_at(const Image& radiance, int x, int y) {
    return {1, static_cast<double>(radiance(x, y)), laplacian(radiance, x, y)};
}

/// Node after node of o, g and c less the mean light.
Eigen::MatrixXd fit_nodes(const Image& brightness, const Image& ceiling, const Image& radiance,
                          const FrameLight& mean, const Nodes& nodes, const LightNodes& options) {
    const Eigen::Index n = nodes.count();
    const std::size_t fields = options.has_sharpness ? kFields : kFields - 1;
    const auto row = [n](std::size_t field, Eigen::Index node) {
        return static_cast<Eigen::Index>(field) * n + node;
    };
    const Eigen::Index size = static_cast<Eigen::Index>(fields) * n;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
    double pixels = 0;
    const int border = options.border;
    for (int y = border; y < brightness.height() - border; ++y) {
        for (int x = border; x < brightness.width() - border; ++x) {
            if (brightness(x, y) >= ceiling(x, y)) continue;
            const std::array<double, kFields> term = terms_at(radiance, x, y);
            const double left =
                static_cast<double>(brightness(x, y)) - mean.offset - mean.gain * term[1];
            if (std::abs(left) > kUnexplained * mean.gain) continue;
            const Nodes::Share share = nodes.at(x, y);
            for (std::size_t p = 0; p < fields; ++p) {
                for (std::size_t i = 0; i < 4; ++i) {
                    const Eigen::Index here = row(p, share.node[i]);
                    const double weight = share.weight[i] * term[p];
                    b(here) += weight * left;
                    for (std::size_t q = 0; q <= p; ++q) {
                        for (std::size_t j = 0; j < 4; ++j) {
                            a(here, row(q, share.node[j])) += weight * share.weight[j] * term[q];
                        }
                    }
                }
            }
            pixels += 1;
        }
    }
    const double stiff = std::max(1.0, kStiffness * pixels / static_cast<double>(n));
    nodes.each_pair([&](Eigen::Index i, Eigen::Index j) {
        for (std::size_t p = 0; p < fields; ++p) {
            a(row(p, i), row(p, i)) += stiff;
            a(row(p, j), row(p, j)) += stiff;
            a(row(p, std::max(i, j)), row(p, std::min(i, j))) -= stiff;
        }
    });
    a.diagonal().array() += 1e-6 * stiff;
    Eigen::MatrixXd light = Eigen::MatrixXd::Zero(n, kFields);
    const Eigen::VectorXd solved = a.selfadjointView<Eigen::Lower>().ldlt().solve(b);
    for (std::size_t p = 0; p < fields; ++p) {
        light.col(static_cast<Eigen::Index>(p)) = solved.segment(row(p, 0), n);
    }
    return light;
}

}  // namespace

void even_out(Image& brightness, Image& ceiling, const Image& radiance, const LightNodes& options) {
    const FrameLight mean = fit_light(brightness, ceiling, radiance, options.border);
    const Nodes nodes(brightness, options.spacing);
    const Eigen::MatrixXd light = fit_nodes(brightness, ceiling, radiance, mean, nodes, options);
    for (int y = 0; y < brightness.height(); ++y) {
        for (int x = 0; x < brightness.width(); ++x) {
            const Nodes::Share share = nodes.at(x, y);
            Eigen::Vector3d here(mean.offset, mean.gain, 0);
            for (std::size_t i = 0; i < 4; ++i) {
                here += share.weight[i] * light.row(share.node[i]).transpose();
            }
            const double gain = std::max(here(1), kLeastGain * mean.gain);
            const double added = here(0) + here(2) * laplacian(radiance, x, y);
            const auto evened = [&](float value) {
                return static_cast<float>((static_cast<double>(value) - added) / gain);
            };
            brightness(x, y) = evened(brightness(x, y));
            ceiling(x, y) = evened(ceiling(x, y));
        }
    }
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
