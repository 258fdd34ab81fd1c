// Synthesis under stress: part of a frame of known truth, made harder or described wrongly.
//
//   bench.tracking.synthesis_stress FRAME TRUTH.csv DIAMETER [--height-unit PX] [--side A] [--only
//   NAME]
//
// FRAME: any image of mirror-like spheres, 1.94 a between the plates. TRUTH.csv: columns x, y [px]
// and z, in units of `--height-unit` (1: pixels). The middle of the frame, `--side` diameters wide
// (24), is looked at; scored are spheres 2 a or more within it. Discs are searched for in the
// whole frame, as it was made harder; they are the start. Prints a table; "says" is what a user is
// told: more than 1 % of the spheres doubtful, a residual that did not fall, or more than 3 % of
// the contrast that is not explained, white noise apart. Errors of heights are about their mean,
// which has a column of its own.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/frame_source.h"
#include "core/image_mat.h"
#include "core/image_part.h"
#include "core/support/random.h"
#include "io/frame_files.h"
#include "tests/support/csv_rows.h"
#include "tests/support/position_score.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/synthesis/film_synthesis.h"
#include "tracking/synthesis/synthesis.h"
#include "tracking/tracking.h"

namespace {

using namespace grainfield;

constexpr double kHeight = 1.94;  // [a]

struct Scene {
    Image image;
    double diameter = 0;         // [px]
    std::vector<Vec2> position;  // [px]
    std::vector<double> z;       // [a]
};

// What is done to the scene, and what synthesis is told.
struct Stress {
    std::string name;
    double noise = 0;           // [contrast]
    double scale = 0;           // [px/a]; 0: as it is
    double dust = 0;            // specks a sphere
    int removed_of = 0;         // one disc in so many is left out
    bool wrong_optics = false;  // reflectivity .95 and twice the blur, not fitted
    double height = kHeight;    // that is told [a]
    double diameter_error = 0;  // of what is told [-]
};

const std::vector<Stress>& stresses() {
    static const std::vector<Stress> all{
        {.name = "none"},
        {.name = "noise 5 % of the contrast", .noise = 0.05},
        {.name = "8 px a diameter", .scale = 8},
        {.name = "dust, a speck to 10 spheres", .dust = 0.1},
        {.name = "1 disc in 20 left out", .removed_of = 20},
        {.name = "optics given, wrong", .wrong_optics = true},
        {.name = "height 2.3 a given", .height = 2.3},
        {.name = "diameter 3 % too large", .diameter_error = 0.03},
    };
    return all;
}

// Of the darkest and brightest percent.
double contrast_of(const Image& image) {
    std::vector<float> sorted(image.pixels().begin(), image.pixels().end());
    std::ranges::sort(sorted);
    return static_cast<double>(sorted[sorted.size() * 99 / 100] - sorted[sorted.size() / 100]);
}

void add_noise(Scene& scene, double share, RandomStream& random) {
    const double sigma = share * contrast_of(scene.image);
    for (float& v : scene.image.pixels()) v += static_cast<float>(sigma * random.normal());
}

// Each pixel the mean of what it covers, as a camera of fewer pixels sees it.
void shrink(Scene& scene, double pixels) {
    const double factor = pixels / scene.diameter;
    Image small(static_cast<int>(std::floor(scene.image.width() * factor)),
                static_cast<int>(std::floor(scene.image.height() * factor)));
    cv::Mat out = as_mat(small);
    cv::resize(as_mat(scene.image), out, out.size(), 0, 0, cv::INTER_AREA);
    const double x = static_cast<double>(small.width()) / scene.image.width();
    const double y = static_cast<double>(small.height()) / scene.image.height();
    for (Vec2& p : scene.position) p = {(p.x + 0.5) * x - 0.5, (p.y + 0.5) * y - 0.5};
    scene.image = std::move(small);
    scene.diameter *= x;
}

// Round specks of .1 to .2 a across that take away .6 of the light.
void add_dust(Scene& scene, double specks_a_sphere, RandomStream& random) {
    const auto count = static_cast<int>(specks_a_sphere * static_cast<double>(scene.z.size()));
    for (int speck = 0; speck < count; ++speck) {
        const double cx = scene.image.width() * random.uniform();
        const double cy = scene.image.height() * random.uniform();
        const double radius = scene.diameter * (0.05 + 0.05 * random.uniform());
        for (int y = std::max(0, static_cast<int>(cy - radius) - 1);
             y <= std::min(scene.image.height() - 1, static_cast<int>(cy + radius) + 1); ++y) {
            for (int x = std::max(0, static_cast<int>(cx - radius) - 1);
                 x <= std::min(scene.image.width() - 1, static_cast<int>(cx + radius) + 1); ++x) {
                const double cover = std::clamp(radius - std::hypot(x - cx, y - cy) + 0.5, 0., 1.);
                scene.image(x, y) *= static_cast<float>(1 - 0.6 * cover);
            }
        }
    }
}

double rms_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v / static_cast<double>(values.size());
    return std::sqrt(sum);
}

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    for (double& v : values) v = std::abs(v);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void print_line(const Stress& stress, const Scene& part, const tracking::Synthesis& found) {
    const double a = part.diameter;
    const int width = part.image.width();
    const int height = part.image.height();
    // As `track` reports: not those cut by the border.
    std::vector<Vec2> inside;
    std::vector<std::size_t> number;
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        if (std::min({p.x, p.y, width - 1 - p.x, height - 1 - p.y}) < 0.5 * a) continue;
        inside.push_back(p);
        number.push_back(i);
    }
    const auto score =
        grainfield::testing::score_positions(inside, part.position, 0.5 * a, width, height, 2 * a);
    std::vector<double> plane, vertical, error, z_error;
    for (std::size_t i = 0; i < part.position.size(); ++i) {
        const Vec2 p = part.position[i];
        const bool is_inner = std::min({p.x, p.y, width - 1 - p.x, height - 1 - p.y}) >= 2 * a;
        if (score.partner[i] < 0 || !is_inner) continue;
        const std::size_t j = number[static_cast<std::size_t>(score.partner[i])];
        const Vec2 off = found.position[j] - p;
        plane.insert(plane.end(), {off.x / a, off.y / a});
        error.insert(error.end(), {found.error[j].x / a, found.error[j].y / a});
        vertical.push_back(found.z[j] - part.z[i]);
        z_error.push_back(found.z_error[j]);
    }
    double mean = 0;
    for (const double v : vertical) mean += v / static_cast<double>(vertical.size());
    for (double& v : vertical) v -= mean;
    const auto within = [](const std::vector<double>& errors, const std::vector<double>& sigma) {
        double count = 0;
        for (std::size_t i = 0; i < errors.size(); ++i) count += std::abs(errors[i]) < 2 * sigma[i];
        return 100 * count / static_cast<double>(errors.size());
    };
    tracking::SynthesisedFrame frame;
    frame.position = found.position;
    frame.residual_before = found.residual_before;
    frame.residual_rms = found.residual_rms;
    frame.unexplained = found.unexplained;
    frame.doubtful = found.doubtful;
    tracking::SynthesisSummary summary;
    tracking::add(frame, 0, summary);
    std::string says = summary.doubtful_frames > 0 ? "doubtful" : "";
    if (summary.risen_frames > 0) says += " not converged";
    if (summary.unexplained_frames > 0) says += " unexplained";
    const double doubtful = 100 * summary.worst_share;
    fmt::print(
        "| {} | {} | {} | {} | {:.4f} | {:.4f} | {:.0f} % | {:.3f} | {:.3f} | {:.3f} | {:.0f} % | "
        "{:.1f} % "
        "| {:.4f} → {:.4f}, {:.4f} | {} |\n",
        stress.name, score.matched, score.missed, score.spurious, rms_of(plane), median_of(plane),
        within(plane, error), mean, rms_of(vertical), median_of(vertical),
        within(vertical, z_error), doubtful, found.residual_before, found.residual_rms,
        found.unexplained, says);
}

void run(const Stress& stress, Scene scene, double side) {
    RandomStream random(1, "stress");
    if (stress.scale > 0) shrink(scene, stress.scale);
    if (stress.dust > 0) add_dust(scene, stress.dust, random);
    if (stress.noise > 0) add_noise(scene, stress.noise, random);
    const double a = scene.diameter;
    const Snapshot discs = tracking::locate(scene.image);

    const int length = static_cast<int>(side * a);
    const int x0 = std::max(0, (scene.image.width() - length) / 2);
    const int y0 = std::max(0, (scene.image.height() - length) / 2);
    Scene part{part_of(scene.image, x0, y0, std::min(length, scene.image.width()),
                       std::min(length, scene.image.height())),
               a,
               {},
               scene.z};
    const Vec2 corner{static_cast<double>(x0), static_cast<double>(y0)};
    for (const Vec2 p : scene.position) part.position.push_back(p - corner);

    RunPlan plan;
    const auto calibration = tracking::calibrate(part.image, {}, {}, {}, 0, plan);
    if (!calibration) throw std::runtime_error(stress.name + ": nothing to calibrate on");
    tracking::SynthesisStart start;
    int number = 0;
    for (const Vec2 found : discs.position) {
        const Vec2 p = found - corner;
        const double beyond =
            std::max({-p.x, -p.y, p.x - part.image.width(), p.y - part.image.height()});
        if (beyond > 0.5 * a) continue;
        if (stress.removed_of > 0 && ++number % stress.removed_of == 0) continue;
        start.position.push_back(p);
    }
    if (stress.wrong_optics) {
        start.optics.reflectivity = 0.95;
        start.optics.blur = 0.14;
        start.are_optics_known = true;
    }
    const tracking::SynthesisOptions options{.height = stress.height};
    print_line(stress, part,
               tracking::synthesise(part.image, calibration->model, a * (1 + stress.diameter_error),
                                    start, options, 0));
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::vector<std::string> words(argv + 1, argv + argc);
        if (words.size() < 3 || words.size() % 2 == 0) {
            throw std::invalid_argument(
                "give FRAME TRUTH.csv DIAMETER and pairs of option and value");
        }
        double height_unit = 1;
        double side = 24;
        std::string only;
        for (std::size_t i = 3; i < words.size(); i += 2) {
            if (words[i] == "--height-unit") {
                height_unit = std::stod(words[i + 1]);
            } else if (words[i] == "--side") {
                side = std::stod(words[i + 1]);
            } else if (words[i] == "--only") {
                only = words[i + 1];
            } else {
                throw std::invalid_argument("no option " + words[i]);
            }
        }
        Scene scene;
        scene.image = io::open_frames({words[0]}, {})->read(0).image;
        scene.diameter = std::stod(words[2]);
        for (auto& row : grainfield::testing::csv_rows(words[1])) {
            scene.position.push_back({std::stod(row["x"]), std::stod(row["y"])});
            scene.z.push_back(std::stod(row["z"]) * height_unit / scene.diameter);
        }
        fmt::print(
            "| stress | found | missed | false | rms x, y [a] | median | within 2σ | mean z [a] | "
            "rms z | "
            "median | within 2σ | doubtful | residual before → after, no noise | says |\n"
            "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
        for (const Stress& stress : stresses()) {
            if (only.empty() || stress.name.starts_with(only)) run(stress, scene, side);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
