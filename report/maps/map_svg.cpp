#include "report/maps/map_svg.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "report/figures/colours.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr double width = 900;  // of the map itself
constexpr double top = 34;
constexpr double side = 90;  // for the colour bar
constexpr std::size_t steps = 32;

// Paths of dots, one a colour; the last collects particles without |Q4|.
std::string discs(const ParticleMap& map, double scale) {
    std::vector<std::string> path(steps + 1);
    for (std::size_t i = 0; i < map.position.size(); ++i) {
        const Vec2 p = map.position[i];
        const double q =
            map.abs_q4.empty() ? std::numeric_limits<double>::quiet_NaN() : map.abs_q4[i];
        const auto step =
            std::isfinite(q)
                ? static_cast<std::size_t>(std::lround(std::clamp(q, 0.0, 1.0) * (steps - 1)))
                : steps;
        const double y = map.y_down ? p.y - map.y[0] : map.y[1] - p.y;
        fmt::format_to(std::back_inserter(path[step]), "M{:.2f} {:.2f}h.01",
                       (p.x - map.x[0]) * scale, y * scale);
    }
    std::string out = fmt::format(
        "<g fill=\"none\" stroke-linecap=\"round\" stroke-width=\"{:.3f}\" "
        "clip-path=\"url(#frame)\">\n",
        0.85 * map.diameter * scale);
    for (std::size_t step = 0; step <= steps; ++step) {
        if (path[step].empty()) continue;
        const double q = step == steps ? std::numeric_limits<double>::quiet_NaN()
                                       : static_cast<double>(step) / (steps - 1);
        out += fmt::format("<path stroke=\"{}\" d=\"{}\"/>\n", hex(viridis(q)), path[step]);
    }
    return out + "</g>\n";
}

std::string colour_bar(double height, const std::string& order) {
    const double x = width + 22;
    const double length = std::min(300.0, height);
    std::string out = "<defs><linearGradient id=\"order\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">";
    for (int i = 0; i <= 10; ++i) {
        out += fmt::format("<stop offset=\"{0}\" stop-color=\"{1}\"/>", i / 10.0,
                           hex(viridis(i / 10.0)));
    }
    out += fmt::format(
        "</linearGradient></defs>\n<rect x=\"{}\" y=\"0\" width=\"14\" height=\"{:.1f}\" "
        "fill=\"url(#order)\"/>\n",
        x, length);
    for (double q : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        out += fmt::format("<text x=\"{}\" y=\"{:.1f}\">{}</text>\n", x + 20,
                           std::clamp((1 - q) * length + 5, 12.0, length), q);
    }
    return out + fmt::format("<text x=\"{}\" y=\"-12\">{}</text>\n", x, order);
}

}  // namespace

std::string map_svg(const ParticleMap& map, const std::string& run_label) {
    const double scale = width / (map.x[1] - map.x[0]);
    const double height = (map.y[1] - map.y[0]) * scale;
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
        "viewBox=\"0 0 {0} {1:.1f}\" width=\"{0}\" height=\"{1:.1f}\" "
        "font-family=\"sans-serif\" font-size=\"15\" fill=\"#1a1a1a\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        "<g transform=\"translate(0 {2})\">\n"
        "<clipPath id=\"frame\"><rect width=\"{3}\" height=\"{4:.1f}\"/></clipPath>\n"
        "<text x=\"0\" y=\"-12\">{5}, {6}</text>\n",
        width + side, height + top, top, width, height, escape_html(run_label),
        escape_html(map.title));
    if (!map.png.empty()) {
        // The image's corner (-0.5, -0.5) is the corner of the map, so it starts at 0, 0.
        out += fmt::format(
            "<image width=\"{:.2f}\" height=\"{:.2f}\" preserveAspectRatio=\"none\" "
            "style=\"image-rendering:pixelated\" xlink:href=\"data:image/png;base64,{}\"/>\n",
            map.image_size[0] * scale, map.image_size[1] * scale, base64(map.png));
    }
    out += discs(map, scale);
    out += fmt::format("<rect width=\"{}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#888\"/>\n",
                       width, height);
    if (!map.abs_q4.empty()) out += colour_bar(height, map.order);
    return out + "</g>\n</svg>\n";
}

}  // namespace grainfield::report
