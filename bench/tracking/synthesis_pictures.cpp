// Frame, rendering and difference side by side, and what synthesis found, of any frame.
//
//   bench.tracking.synthesis_pictures FRAME DIAMETER OUT.png [--height H] [--part X,Y,WIDTH,HEIGHT]
//                                     [--show X,Y,WIDTH,HEIGHT]
//
// DIAMETER: true diameter a [px]. `--height`: distance of the plates, 1.94 [a]. `--part` of the
// frame is fitted, `--show` of that is drawn; all unless given. Brightness runs from the core of a
// sphere (black) to the panel (white). The difference is drawn five times as strong about grey.
// Prints the residual, the optics, how many spheres there are, the two centres nearest in space,
// and the shares of heights near each plate, of spheres 3 a or more within the part.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/frame_source.h"
#include "core/image_part.h"
#include "io/frame_files.h"
#include "report/maps/png.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/synthesis/synthesis.h"
#include "tracking/tracking.h"

namespace {

using namespace grainfield;

struct Part {
    int x = 0, y = 0, width = 0, height = 0;  // [px]
};

Part part_from(const std::string& text) {
    Part part;
    if (std::sscanf(text.c_str(), "%d,%d,%d,%d", &part.x, &part.y, &part.width, &part.height) !=
        4) {
        throw std::invalid_argument("'" + text + "' is no X,Y,WIDTH,HEIGHT");
    }
    return part;
}

// The three beside each other, 4 px of white between them, in counts of 0 to 255.
Image side_by_side(const Image& frame, const Image& rendering, const Image& difference) {
    constexpr int gap = 4;
    const int width = frame.width();
    Image all(3 * width + 2 * gap, frame.height(), 255.0F);
    for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            const auto grey = [](float value) { return 255 * std::clamp(value, 0.0F, 1.0F); };
            all(x, y) = grey(frame(x, y) / 1.1F);
            all(x + width + gap, y) = grey(rendering(x, y) / 1.1F);
            all(x + 2 * (width + gap), y) = grey(0.5F + 2.5F * difference(x, y));
        }
    }
    return all;
}

void print_facts(const tracking::Synthesis& found, double a, double height, int width, int rows) {
    fmt::print("residual {:.4f} → {:.4f} of the contrast, {:.4f} of it not white noise\n",
               found.residual_before, found.residual_rms, found.unexplained);
    fmt::print("F0 {:.3f}, blur {:.4f} a, ambient {:.3f}, grazing {:.3f}\n",
               found.optics.reflectivity, found.optics.blur, found.optics.ambient,
               found.optics.grazing);
    const double top = height - 1;
    double closest = 1e9, near_low = 0, near_high = 0, inner = 0, overlapping = 0;
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        if (std::min({p.x, p.y, width - 1 - p.x, rows - 1 - p.y}) < 3 * a) continue;
        inner += 1;
        near_low += found.z[i] < 0.1 ? 1 : 0;
        near_high += found.z[i] > top - 0.1 ? 1 : 0;
        double nearest = 1e9;
        for (std::size_t j = 0; j < found.position.size(); ++j) {
            if (j == i) continue;
            const Vec2 d = (1 / a) * (found.position[j] - p);
            nearest = std::min(nearest, std::hypot(d.x, d.y, found.z[j] - found.z[i]));
        }
        closest = std::min(closest, nearest);
        overlapping += nearest < 0.95 ? 1 : 0;
    }
    fmt::print("{} spheres ({} added, {} removed, {} moved, {} doubtful)\n", found.position.size(),
               found.added, found.removed, found.lifted, found.doubtful);
    if (inner == 0) return;
    fmt::print(
        "{} of them 3 a within: closest two centres {:.2f} a, {:.0f} % nearer than .95 a to "
        "another; within .1 a of the low plate {:.0f} %, of the high one {:.0f} %\n",
        inner, closest, 100 * overlapping / inner, 100 * near_low / inner, 100 * near_high / inner);
}

void run(const std::vector<std::string>& words) {
    if (words.size() < 3 || words.size() % 2 == 0) {
        throw std::invalid_argument("give FRAME DIAMETER OUT.png and pairs of option and value");
    }
    const Image whole = io::open_frames({words[0]}, {})->read(0).image;
    const double a = std::stod(words[1]);
    double height = 1.94;
    Part fitted{0, 0, whole.width(), whole.height()};
    Part shown;
    for (std::size_t i = 3; i < words.size(); i += 2) {
        if (words[i] == "--height") {
            height = std::stod(words[i + 1]);
        } else if (words[i] == "--part") {
            fitted = part_from(words[i + 1]);
        } else if (words[i] == "--show") {
            shown = part_from(words[i + 1]);
        } else {
            throw std::invalid_argument("no option " + words[i]);
        }
    }
    if (shown.width == 0) shown = {0, 0, fitted.width, fitted.height};
    const Image image = part_of(whole, fitted.x, fitted.y, fitted.width, fitted.height);
    const Snapshot discs = tracking::locate(whole);
    RunPlan plan;
    const auto calibration = tracking::calibrate(image, {}, {}, {}, 0, plan);
    if (!calibration) throw std::runtime_error("nothing to calibrate on");
    tracking::SynthesisStart start;
    for (const Vec2 disc : discs.position) {
        const Vec2 p = disc - Vec2{1.0 * fitted.x, 1.0 * fitted.y};
        const double beyond = std::max({-p.x, -p.y, p.x - image.width(), p.y - image.height()});
        if (beyond <= 0.5 * a) start.position.push_back(p);
    }
    const tracking::Synthesis found =
        tracking::synthesise(image, calibration->model, a, start, {.height = height}, 0);
    print_facts(found, a, height, image.width(), image.height());

    Image brightness = calibration->model.darkness(image);
    for (float& v : brightness.pixels()) v = 1 - v;
    Image rendering = brightness;
    for (std::size_t i = 0; i < rendering.pixels().size(); ++i) {
        rendering.pixels()[i] -= found.residual_map.pixels()[i];
    }
    const auto cut = [&](const Image& from) {
        return part_of(from, shown.x, shown.y, shown.width, shown.height);
    };
    const Image picture = side_by_side(cut(brightness), cut(rendering), cut(found.residual_map));
    std::vector<std::uint8_t> rgb;
    for (const float grey : picture.pixels()) {
        rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(grey)));
    }
    const std::vector<std::uint8_t> png =
        report::encode_png(rgb, picture.width(), picture.height());
    std::ofstream out(words[2], std::ios::binary);
    out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
    if (!out) throw std::runtime_error("cannot write " + words[2]);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
