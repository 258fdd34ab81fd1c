#include "report/maps/map_pdf.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "report/figures/colours.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr double width = 480;  // of the map, in points of 1/72 inch
constexpr double margin = 12;
constexpr double side = 54;  // for the colour bar
constexpr std::size_t steps = 32;

std::string rgb(Colour colour, const char* what) {
    return fmt::format("{:.3f} {:.3f} {:.3f} {}\n", colour[0] / 255.0, colour[1] / 255.0,
                       colour[2] / 255.0, what);
}

// Dots with round caps, a path for each colour; the last collects particles without |Q4|.
std::string discs(const ParticleMap& map, double scale) {
    std::vector<std::string> path(steps + 1);
    for (std::size_t i = 0; i < map.position.size(); ++i) {
        const double q =
            map.abs_q4.empty() ? std::numeric_limits<double>::quiet_NaN() : map.abs_q4[i];
        const auto step =
            std::isfinite(q)
                ? static_cast<std::size_t>(std::lround(std::clamp(q, 0.0, 1.0) * (steps - 1)))
                : steps;
        const Vec2 p = map.position[i];
        // A page counts upwards, so do simulations.
        const double x = (p.x - map.x[0]) * scale;
        const double y = (map.y_down ? map.y[1] - p.y : p.y - map.y[0]) * scale;
        fmt::format_to(std::back_inserter(path[step]), "{0:.2f} {1:.2f} m {0:.2f} {1:.2f} l\n", x,
                       y);
    }
    std::string out = fmt::format("1 J {:.3f} w\n", 0.85 * map.diameter * scale);
    for (std::size_t step = 0; step <= steps; ++step) {
        if (path[step].empty()) continue;
        const double q = step == steps ? std::numeric_limits<double>::quiet_NaN()
                                       : static_cast<double>(step) / (steps - 1);
        out += rgb(viridis(q), "RG") + path[step] + "S\n";
    }
    return out;
}

std::string colour_bar(double height) {
    const double x = width + 12;
    const double length = std::min(200.0, height);
    std::string out;
    for (std::size_t i = 0; i < steps; ++i) {
        const double low = height - length + length * static_cast<double>(i) / steps;
        out += rgb(viridis(static_cast<double>(i) / (steps - 1)), "rg") +
               fmt::format("{:.1f} {:.2f} 9 {:.2f} re f\n", x, low, length / steps + 0.2);
    }
    out += "0 g BT /F1 9 Tf\n";
    for (double q : {0.0, 0.5, 1.0}) {
        out += fmt::format("1 0 0 1 {:.1f} {:.1f} Tm ({:.1f}) Tj\n", x + 12,
                           height - length + q * (length - 7), q);
    }
    return out + "ET\n";
}

// UTF-8 as a PDF text string: UTF-16, big end first, in hexadecimal.
std::string text_string(const std::string& utf8) {
    std::string out = "<FEFF";
    for (std::size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i]);
        const std::size_t more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
        std::uint32_t code = more == 0 ? lead : lead & (0x3FU >> more);
        for (std::size_t j = 1; j <= more && i + j < utf8.size(); ++j) {
            code = code << 6U | (static_cast<unsigned char>(utf8[i + j]) & 0x3FU);
        }
        i += more + 1;
        if (code >= 0x10000) {
            code -= 0x10000;
            out += fmt::format("{:04X}{:04X}", 0xD800 + (code >> 10U), 0xDC00 + (code & 0x3FFU));
        } else {
            out += fmt::format("{:04X}", code);
        }
    }
    return out + ">";
}

// Objects with their numbers in order, and the table that says where each begins.
std::string document(const std::vector<std::string>& objects) {
    std::string out = "%PDF-1.4\n%\xE2\xE3\xCF\xD3\n";
    std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
    for (std::size_t i = 0; i < objects.size(); ++i) {
        table += fmt::format("{:010} 00000 n \n", out.size());
        out += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
    }
    const std::size_t start = out.size();
    return out + table +
           fmt::format("trailer\n<< /Size {} /Root 1 0 R /Info 6 0 R >>\nstartxref\n{}\n%%EOF\n",
                       objects.size() + 1, start);
}

}  // namespace

std::string map_pdf(const ParticleMap& map, const std::string& run_label) {
    const double scale = width / (map.x[1] - map.x[0]);
    const double height = (map.y[1] - map.y[0]) * scale;
    std::string page = fmt::format("q 1 0 0 1 {0} {0} cm\n", margin);
    page += fmt::format("q 0 0 {} {:.2f} re W n\n", width, height) + discs(map, scale) + "Q\n";
    page += fmt::format("0.5 G 0.6 w 0 0 {} {:.2f} re S\n", width, height);
    if (!map.abs_q4.empty()) page += colour_bar(height);
    page += "Q\n";
    return document(
        {"<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
         fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.1f} {:.1f}] /Contents 4 0 R "
                     "/Resources << /Font << /F1 5 0 R >> >> >>",
                     width + side + 2 * margin, height + 2 * margin),
         fmt::format("<< /Length {} >>\nstream\n{}endstream", page.size(), page),
         "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
         "<< /Title " + text_string(clean_text(run_label + ", " + map.title)) + " >>"});
}

}  // namespace grainfield::report
