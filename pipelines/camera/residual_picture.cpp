#include "pipelines/camera/residual_picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace grainfield::pipelines {

namespace {

using tracking::BoardResidual;
using tracking::CameraMap;

constexpr double kWidth = 560;    // of a panel
constexpr double kGap = 40;       // between the two
constexpr double kTop = 46;       // for titles
constexpr double kLongest = 0.1;  // of the longest arrow, share of the frame's width
constexpr int kLines = 12;        // of the grid, along the longer side

std::string arrow(Vec2 from, Vec2 to, double head) {
    const Vec2 step = to - from;
    const double length = norm(step);
    std::string path = fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}", from.x, from.y, to.x, to.y);
    if (length < head) return path;
    const Vec2 back = (-head / length) * step;
    const Vec2 side{-0.5 * back.y, 0.5 * back.x};
    return path + fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}", to.x + back.x + side.x,
                              to.y + back.y + side.y, to.x, to.y, to.x + back.x - side.x,
                              to.y + back.y - side.y);
}

/// A round number of at least half of `value`.
double rounded(double value) {
    const double decade = std::pow(10, std::floor(std::log10(value)));
    const double lead = value / decade;
    return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * decade;
}

std::string path(const char* colour, const std::string& data) {
    return data.empty()
               ? ""
               : fmt::format("<path fill=\"none\" stroke=\"{}\" d=\"{}\"/>\n", colour, data);
}

/// Lines that are straight in the plane of the cell, as the picture has them.
std::string grid(const tracking::Camera& camera, double scale) {
    const CameraMap map(camera);
    const double step = std::max(camera.width, camera.height) / static_cast<double>(kLines);
    const auto line = [&](Vec2 from, Vec2 to) {
        constexpr int pieces = 48;
        std::string data;
        for (int i = 0; i <= pieces; ++i) {
            const Vec2 p =
                scale * map.in_picture(from + (static_cast<double>(i) / pieces) * (to - from));
            data += fmt::format("{}{:.2f} {:.2f}", i == 0 ? 'M' : 'L', p.x, p.y);
        }
        return data;
    };
    // Some lines beside the frame, too: its sides may be bent inwards.
    const double left = -3 * step;
    const double up = -3 * step;
    const double right = camera.width + 3 * step;
    const double down = camera.height + 3 * step;
    std::string data;
    for (double x = left; x <= right; x += step) data += line({x, up}, {x, down});
    for (double y = up; y <= down; y += step) data += line({left, y}, {right, y});
    return path("#b0413e", data);
}

}  // namespace

std::string residual_picture(const tracking::CameraFit& fit, std::size_t cell_view) {
    const tracking::Camera& camera = fit.camera;
    const double scale = kWidth / camera.width;
    const double height = scale * camera.height;
    double longest = 0;
    for (const BoardResidual& point : fit.residuals) {
        longest = std::max(longest, norm(point.residual));
    }
    // Corners that were given fit exactly, but for rounding.
    const bool is_exact = longest < 1e-6;
    const double enlarged = is_exact ? 1 : kLongest * camera.width / longest;
    std::string others;
    std::string cell;
    for (const BoardResidual& point : fit.residuals) {
        const Vec2 from = scale * (point.pixel - point.residual);
        (point.view == cell_view ? cell : others) +=
            arrow(from, from + enlarged * scale * point.residual, 5);
    }
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
        "width=\"{0:.0f}\" height=\"{1:.0f}\" font-family=\"sans-serif\" font-size=\"14\" "
        "fill=\"#1a1a1a\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        2 * kWidth + 3 * kGap, height + kTop + 2 * kGap);
    const auto panel = [&](double x, const std::string& title, const std::string& content) {
        out += fmt::format(
            "<g transform=\"translate({:.0f} {:.0f})\">\n<text x=\"0\" y=\"-12\">{}</text>\n"
            "<svg width=\"{:.1f}\" height=\"{:.1f}\">\n{}</svg>\n"
            "<rect width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#888\"/>\n</g>\n",
            x, kTop, title, kWidth, height, content, kWidth, height);
    };
    panel(kGap,
          fmt::format("Residuals of {} points, {:.3f} px RMS per axis", fit.residuals.size(),
                      camera.residual_rms),
          path("#a8a8a8", others) + path("#1f4e9c", cell));
    panel(2 * kGap + kWidth, "Straight lines of the plane, as the picture has them",
          grid(camera, scale));
    if (!is_exact) {
        const double shown = rounded(longest);
        const double y = kTop + height + kGap;
        const double end = kGap + shown * enlarged * scale;
        out += path("#1a1a1a", arrow({kGap, y}, {end, y}, 5));
        out += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\">{:g} px; blue: the board in the plane of the "
            "cell</text>\n",
            end + 10, y + 5, shown);
    }
    return out + "</svg>\n";
}

}  // namespace grainfield::pipelines
