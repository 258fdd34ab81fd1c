#include "tests/support/tilted_camera.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace grainfield::testing {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix times(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
        }
    }
    return c;
}

Matrix rotation(const std::array<double, 3>& turn) {
    const auto [a, b, g] = turn;
    const Matrix x{{{1, 0, 0}, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)}}};
    const Matrix y{{{std::cos(b), 0, std::sin(b)}, {0, 1, 0}, {-std::sin(b), 0, std::cos(b)}}};
    const Matrix z{{{std::cos(g), -std::sin(g), 0}, {std::sin(g), std::cos(g), 0}, {0, 0, 1}}};
    return times(z, times(y, x));
}

/// A disc of diameter 2R seen at a distance r of its centre, the tracker's edge.
double darkness(double r, double radius, double width) {
    return 0.5 * (1 - std::tanh((r - radius) / width));
}

/// Every pixel of the frame, with noise. `brightness` is told the place that the pixel shows, and
/// the steps in the plane to the next pixel on the right and below.
template <class Brightness>
Image rendered(const TiltedCamera& camera, const Pose& pose, double noise, std::uint64_t seed,
               const Brightness& brightness) {
    Image image(camera.width, camera.height);
    const auto columns = static_cast<std::size_t>(camera.width) + 2;
    std::vector<Vec2> place;
    for (int y = -1; y <= camera.height; ++y) {
        for (int x = -1; x <= camera.width; ++x) {
            place.push_back(
                camera.place_at({static_cast<double>(x), static_cast<double>(y)}, pose));
        }
    }
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y + 1) * columns + static_cast<std::size_t>(x + 1);
            const double value = brightness(place[i], 0.5 * (place[i + 1] - place[i - 1]),
                                            0.5 * (place[i + columns] - place[i - columns]));
            image(x, y) = static_cast<float>(
                std::clamp(std::round(value + noise * normal(random)), 0.0, 255.0));
        }
    }
    return image;
}

}  // namespace

Vec2 TiltedCamera::seen(Vec2 place, const Pose& pose) const {
    const Matrix r = rotation(pose.turn);
    std::array<double, 3> p = pose.shift;
    for (std::size_t i = 0; i < 3; ++i) p[i] += r[i][0] * place.x + r[i][1] * place.y;
    const double x = p[0] / p[2];
    const double y = p[1] / p[2];
    const double r2 = x * x + y * y;
    const double radial = 1 + k1 * r2 + k2 * r2 * r2;
    return {focal * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + centre.x,
            focal * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + centre.y};
}

Vec2 TiltedCamera::place_at(Vec2 pixel, const Pose& pose) const {
    const double xd = (pixel.x - centre.x) / focal;
    const double yd = (pixel.y - centre.y) / focal;
    double x = xd;
    double y = yd;
    for (int i = 0; i < 12; ++i) {
        const double r2 = x * x + y * y;
        const double radial = 1 + k1 * r2 + k2 * r2 * r2;
        const double dx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
        const double dy = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
        x = (xd - dx) / radial;
        y = (yd - dy) / radial;
    }
    // The ray (x, y, 1) meets the plane.
    const Matrix r = rotation(pose.turn);
    const auto& t = pose.shift;
    const double a = r[0][0] - x * r[2][0], b = r[0][1] - x * r[2][1], c = x * t[2] - t[0];
    const double d = r[1][0] - y * r[2][0], e = r[1][1] - y * r[2][1], f = y * t[2] - t[1];
    const double determinant = a * e - b * d;
    return {(c * e - b * f) / determinant, (a * f - c * d) / determinant};
}

Image TiltedCamera::chessboard(int columns, int rows, const Pose& pose, double noise,
                               std::uint64_t seed) const {
    constexpr double blur = 0.7;
    return rendered(*this, pose, noise, seed, [&](Vec2 p, Vec2 right, Vec2 down) {
        // Distances to the next line in pixels, and on which side of it.
        const auto side = [&](double u, double slope) {
            const double line = std::round(u);
            const double sign = std::lround(line) % 2 == 0 ? 1 : -1;
            return sign * std::erf((u - line) / slope / (std::sqrt(2.0) * blur));
        };
        // Smooth steps at the ends of the board, one square beyond the last corners.
        const auto within = [&](double u, double last, double slope) {
            const double s = std::sqrt(2.0) * blur * slope;
            return 0.25 * (1 + std::erf((u + 1) / s)) * (1 + std::erf((last + 1 - u) / s));
        };
        const double du = std::hypot(right.x, down.x);
        const double dv = std::hypot(right.y, down.y);
        const double on = within(p.x, columns - 1, du) * within(p.y, rows - 1, dv);
        return 128 + 90 * on * side(p.x, du) * side(p.y, dv) + 90 * (1 - on);
    });
}

Image TiltedCamera::discs(const std::vector<Vec2>& place, double diameter, const Pose& pose,
                          double noise, std::uint64_t seed) const {
    // Which discs may reach a pixel, by cells of one diameter in the plane.
    double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
    for (const Vec2 p : place) {
        low_x = std::min(low_x, p.x);
        low_y = std::min(low_y, p.y);
        high_x = std::max(high_x, p.x);
        high_y = std::max(high_y, p.y);
    }
    const auto columns = static_cast<int>((high_x - low_x) / diameter) + 1;
    const auto rows = static_cast<int>((high_y - low_y) / diameter) + 1;
    std::vector<std::vector<Vec2>> cells(static_cast<std::size_t>(columns) *
                                         static_cast<std::size_t>(rows));
    const auto column = [&](Vec2 p) {
        return static_cast<int>(std::floor((p.x - low_x) / diameter));
    };
    const auto row = [&](Vec2 p) { return static_cast<int>(std::floor((p.y - low_y) / diameter)); };
    for (const Vec2 p : place) {
        cells[static_cast<std::size_t>(row(p)) * static_cast<std::size_t>(columns) +
              static_cast<std::size_t>(column(p))]
            .push_back(p);
    }
    return rendered(*this, pose, noise, seed, [&](Vec2 p, Vec2 right, Vec2 down) {
        const double off = defocus * (2 * p.x - low_x - high_x) / (high_x - low_x);
        const double edge = 0.6 * (norm(right) + norm(down)) * std::sqrt(1 + off * off);  // 1.2 px
        double clear = 1;
        for (int j = row(p) - 1; j <= row(p) + 1; ++j) {
            for (int i = column(p) - 1; i <= column(p) + 1; ++i) {
                if (i < 0 || j < 0 || i >= columns || j >= rows) continue;
                for (const Vec2 q :
                     cells[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
                           static_cast<std::size_t>(i)]) {
                    clear *= 1 - darkness(norm(p - q), 0.5 * diameter, edge);
                }
            }
        }
        return 30 + 180 * clear;
    });
}

Image TiltedCamera::cell(double width_of_cell, double height_of_cell, double wall,
                         const std::vector<Vec2>& place, const Pose& pose, double noise,
                         std::uint64_t seed) const {
    constexpr double blur = 0.8;
    return rendered(*this, pose, noise, seed, [&](Vec2 p, Vec2 right, Vec2 down) {
        const double du = std::sqrt(2.0) * blur * std::hypot(right.x, down.x);
        const double dv = std::sqrt(2.0) * blur * std::hypot(right.y, down.y);
        const auto within = [&](double u, double low, double high, double s) {
            return 0.25 * (1 + std::erf((u - low) / s)) * (1 + std::erf((high - u) / s));
        };
        double light = within(p.x, 0, width_of_cell, du) * within(p.y, 0, height_of_cell, dv);
        const double beside = 1 - within(p.x, -wall, width_of_cell + wall, du) *
                                      within(p.y, -wall, height_of_cell + wall, dv);
        for (const Vec2 q : place) light *= 1 - darkness(norm(p - q), 0.5, du);
        return 40 + 150 * light + 90 * beside;
    });
}

Pose held(const std::array<double, 3>& turn, Vec2 middle_of_board, double distance) {
    Pose pose{turn, {0, 0, distance}};
    const Matrix r = rotation(turn);
    for (std::size_t i = 0; i < 3; ++i) {
        pose.shift[i] -= r[i][0] * middle_of_board.x + r[i][1] * middle_of_board.y;
    }
    return pose;
}

std::vector<Pose> board_poses(Vec2 middle_of_board, double distance) {
    std::vector<Pose> poses;
    const std::vector<std::array<double, 5>> ways{
        {0, 0, 0, 0, 0},          {0.4, 0, 0.1, 0, 0},        {-0.4, 0.1, 0, 0, 0},
        {0, 0.4, -0.1, 0, 0},     {0.1, -0.4, 0.2, 0, 0},     {0.3, 0.3, 0.3, 0.05, 0.03},
        {-0.3, 0.3, 0, -0.05, 0}, {0.2, -0.3, -0.2, 0, -0.04}};
    for (const auto& [a, b, g, dx, dy] : ways) {
        Pose pose = held({a, b, g}, middle_of_board, distance);
        pose.shift[0] += distance * dx;
        pose.shift[1] += distance * dy;
        poses.push_back(pose);
    }
    return poses;
}

}  // namespace grainfield::testing
