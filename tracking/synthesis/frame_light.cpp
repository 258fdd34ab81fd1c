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

constexpr double kStiffness = 1e-4;   // of nodes: of the pixels about one
constexpr double kLeastGain = 0.5;    // of the mean
constexpr double kLeastPixels = 100;  // for each unknown
constexpr int kTurns = 3;  // each leaves out what is far from the light of the one before

/// Nodes over an image, and what each of the four about a pixel weighs there.
class LightNodes {
 public:
    LightNodes(const Image& image, double spacing)
        : columns_(along(image.width(), spacing)),
          rows_(along(image.height(), spacing)),
          step_x_(std::max(1.0, (image.width() - 1.0) / (columns_ - 1))),
          step_y_(std::max(1.0, (image.height() - 1.0) / (rows_ - 1))) {}

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

/// Offsets of all nodes, then their gains.
struct NodeLight {
    const LightNodes& nodes;
    Eigen::VectorXd value;

    std::array<double, 2> at(int x, int y) const {
        const LightNodes::Share share = nodes.at(x, y);
        std::array<double, 2> here{};
        for (std::size_t i = 0; i < 4; ++i) {
            here[0] += share.weight[i] * value(share.node[i]);
            here[1] += share.weight[i] * value(nodes.count() + share.node[i]);
        }
        return here;
    }
};

/// The node light nearer to the image than `before`, from pixels that are not far from that one.
/// How many had a say.
double improve(const Image& brightness, const Image& ceiling, const Image& radiance, int border,
               double mean_gain, NodeLight& light) {
    const Eigen::Index n = light.nodes.count();
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * n);
    double pixels = 0;
    for (int y = border; y < brightness.height() - border; ++y) {
        for (int x = border; x < brightness.width() - border; ++x) {
            if (brightness(x, y) >= ceiling(x, y)) continue;
            const auto m = static_cast<double>(radiance(x, y));
            const auto seen = static_cast<double>(brightness(x, y));
            const auto [offset, gain] = light.at(x, y);
            if (std::abs(seen - offset - gain * m) > kUnexplained * mean_gain) continue;
            const LightNodes::Share share = light.nodes.at(x, y);
            for (std::size_t i = 0; i < 4; ++i) {
                const double p = share.weight[i];
                const Eigen::Index here = share.node[i];
                b(here) += p * seen;
                b(n + here) += p * m * seen;
                for (std::size_t j = 0; j < 4; ++j) {
                    const double q = p * share.weight[j];
                    a(here, share.node[j]) += q;
                    a(n + here, share.node[j]) += q * m;
                    a(n + here, n + share.node[j]) += q * m * m;
                }
            }
            pixels += 1;
        }
    }
    if (pixels < kLeastPixels * static_cast<double>(2 * n)) return pixels;
    const double stiff = kStiffness * pixels / static_cast<double>(n);
    light.nodes.each_pair([&](Eigen::Index i, Eigen::Index j) {
        for (const Eigen::Index field : {Eigen::Index{0}, n}) {
            a(field + i, field + i) += stiff;
            a(field + j, field + j) += stiff;
            a(field + std::max(i, j), field + std::min(i, j)) -= stiff;
        }
    });
    a.diagonal().array() += 1e-6 * stiff;
    light.value = a.selfadjointView<Eigen::Lower>().ldlt().solve(b);
    return pixels;
}

}  // namespace

UnevenLight even_out(Image& brightness, Image& ceiling, const Image& radiance, double spacing,
                     int border) {
    const FrameLight mean = fit_light(brightness, ceiling, radiance, border);
    const double mean_gain = mean.gain + 0.5 * mean.fall;
    if (!(mean_gain > 0)) return {};
    const LightNodes nodes(brightness, spacing);
    NodeLight light{nodes, Eigen::VectorXd(2 * nodes.count())};
    light.value.head(nodes.count()).setConstant(mean.offset);
    light.value.tail(nodes.count()).setConstant(mean_gain);
    for (int turn = 0; turn < kTurns; ++turn) {
        const double pixels = improve(brightness, ceiling, radiance, border, mean_gain, light);
        if (pixels < kLeastPixels * static_cast<double>(2 * nodes.count())) return {};
    }
    UnevenLight found{Image(brightness.width(), brightness.height()),
                      Image(brightness.width(), brightness.height())};
    for (int y = 0; y < brightness.height(); ++y) {
        for (int x = 0; x < brightness.width(); ++x) {
            const auto [offset, gain] = light.at(x, y);
            const auto o = static_cast<float>(offset);
            const auto g = static_cast<float>(std::max(gain, kLeastGain * mean_gain));
            found.offset(x, y) = o;
            found.gain(x, y) = g;
            brightness(x, y) = (brightness(x, y) - o) / g;
            ceiling(x, y) = (ceiling(x, y) - o) / g;
        }
    }
    return found;
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

double coherent_rms(const Image& image, int border) {
    double products = 0;
    double n = 0;
    for (int y = border; y < image.height() - border - 1; ++y) {
        for (int x = border; x < image.width() - border - 1; ++x) {
            products += static_cast<double>(image(x, y)) *
                        static_cast<double>(image(x + 1, y) + image(x, y + 1));
            n += 2;
        }
    }
    return n > 0 ? std::sqrt(std::max(0.0, products / n)) : 0;
}

}  // namespace grainfield::tracking
