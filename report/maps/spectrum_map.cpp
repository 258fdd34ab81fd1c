#include "report/maps/spectrum_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "report/figures/colours.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr std::size_t steps = 32;
constexpr double side = 420;  // of the plot
constexpr double margin = 52;

struct Points {
    std::vector<double> kx, ky, log_s;
    double low = 0, high = 0;  // of log_s
    double k_max = 0;
    double dx = 0, dy = 0;  // of the grid
};

// The smallest difference between values; their range if there is one only.
double spacing(std::vector<double> values) {
    std::ranges::sort(values);
    const double range = values.back() - values.front();
    double least = range;
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double d = values[i] - values[i - 1];
        if (d > 1e-9 * range) least = std::min(least, d);
    }
    return least;
}

Points points_of(const Curve& curve) {
    Points points;
    const std::vector<double>& s = curve.find("s")->values;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (!(s[i] > 0) || !std::isfinite(s[i])) continue;
        points.kx.push_back(curve.find("kx")->values[i]);
        points.ky.push_back(curve.find("ky")->values[i]);
        points.log_s.push_back(std::log10(s[i]));
    }
    if (points.log_s.size() < 4) return {};
    std::vector<double> sorted = points.log_s;
    std::ranges::sort(sorted);
    const auto at = [&](double share) {
        return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    };
    points.low = at(0.01);
    points.high = std::max(at(0.99), points.low + 1e-6);
    points.dx = spacing(points.kx);
    points.dy = spacing(points.ky);
    for (std::size_t i = 0; i < points.kx.size(); ++i) {
        points.k_max = std::max({points.k_max, std::abs(points.kx[i]), std::abs(points.ky[i])});
    }
    points.k_max += 0.5 * std::max(points.dx, points.dy);
    return points;
}

std::string colour_bar(const Points& points) {
    std::string out;
    const double x = margin + side + 22;
    for (std::size_t step = 0; step < steps; ++step) {
        const double height = side / steps;
        out += fmt::format(R"(<rect x="{}" y="{:.2f}" width="14" height="{:.2f}" fill="{}"/>)", x,
                           margin + side - static_cast<double>(step + 1) * height, height + 0.4,
                           hex(viridis((static_cast<double>(step) + 0.5) / steps)));
    }
    for (const double part : {0.0, 0.5, 1.0}) {
        out += fmt::format(R"(<text x="{}" y="{:.1f}">{:.2g}</text>)", x + 20,
                           margin + side * (1 - part) + 4,
                           std::pow(10.0, points.low + part * (points.high - points.low)));
    }
    return out + fmt::format(R"(<text x="{}" y="{}">S(k)</text>)", x, margin - 10);
}

}  // namespace

std::string spectrum_map_svg(const Results& run, const std::string& run_label) {
    const ObservableResult* sk = run.find("sk");
    const Curve* curve = sk == nullptr ? nullptr : sk->find_curve("sk_map");
    if (curve == nullptr || curve->find("kx") == nullptr || curve->find("ky") == nullptr ||
        curve->find("s") == nullptr) {
        return "";
    }
    const Points points = points_of(*curve);
    if (points.kx.empty()) return "";
    const double scale = 0.5 * side / points.k_max;
    std::array<std::string, steps> paths;
    for (std::size_t i = 0; i < points.kx.size(); ++i) {
        const double part = (points.log_s[i] - points.low) / (points.high - points.low);
        const auto step =
            static_cast<std::size_t>(std::clamp(part * steps, 0.0, static_cast<double>(steps) - 1));
        for (const double sign : {1.0, -1.0}) {
            const double x = margin + 0.5 * side + scale * (sign * points.kx[i] - 0.5 * points.dx);
            const double y = margin + 0.5 * side - scale * (sign * points.ky[i] + 0.5 * points.dy);
            paths[step] += fmt::format("M{:.2f} {:.2f}h{:.2f}v{:.2f}h{:.2f}z", x, y,
                                       scale * points.dx, scale * points.dy, -scale * points.dx);
        }
    }
    const std::string unit = typeset_text(curve->find("kx")->unit, run.source.time_unit);
    std::string out = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" )"
        R"(font-family="sans-serif" font-size="12" role="img"><title>{2}</title>)",
        side + 2 * margin + 40, side + 2 * margin, escape_html("S(k) by wavevector, " + run_label));
    for (std::size_t step = 0; step < steps; ++step) {
        if (paths[step].empty()) continue;
        out += fmt::format(R"(<path fill="{}" d="{}"/>)",
                           hex(viridis((static_cast<double>(step) + 0.5) / steps)), paths[step]);
    }
    out +=
        fmt::format(R"(<rect x="{0}" y="{0}" width="{1}" height="{1}" fill="none" stroke="#888"/>)",
                    margin, side);
    for (const double part : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const double k = part * points.k_max;
        const double at = 0.5 * side * (1 + part);
        out +=
            fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:.2g}</text>)"
                        R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:.2g}</text>)",
                        margin + at, margin + side + 16, k, margin - 6, margin + side - at + 4, k);
    }
    out += fmt::format(R"(<text x="{}" y="{}" text-anchor="middle">k_x [{}]</text>)"
                       R"(<text x="{}" y="{}">k_y [{}]</text>)",
                       margin + 0.5 * side, margin + side + 36, escape_html(unit), 4, margin - 10,
                       escape_html(unit));
    return out + colour_bar(points) + "</svg>\n";
}

}  // namespace grainfield::report
