#include "bench/tracking/mirror_lessons.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "io/frame_files.h"
#include "tests/support/csv_rows.h"
#include "tracking/film_model.h"
#include "tracking/locate.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/track_options.h"

namespace grainfield::bench {
namespace {

using namespace grainfield::tracking;
namespace fs = std::filesystem;

constexpr double kSame = 0.2;  // [a] a disc and its sphere

double scale_in(const fs::path& file) {
    std::ifstream text(file);
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with("scale = ")) return std::stod(line.substr(8));
    }
    throw std::invalid_argument("no scale in " + file.string());
}

/// Empty: the frame cannot be calibrated, or no sphere of it was found.
std::optional<MirrorLesson> lesson_of(const fs::path& scene, std::uint64_t number) {
    const double scale = scale_in(scene / "optics.toml");
    auto source = io::open_frames({scene / "frame.png"}, {});
    TrackOptions options;
    options.sphere_diameter = scale;
    options.correct_bias = false;
    // As films of mirrors are seen (model_of_film); here whatever a first fit leaves.
    options.binning = mirror_blocks(scale);
    options.detection = detection_of(options);
    RunPlan plan;
    const FilmModel film = model_of_film(*source, options, 2, plan);
    if (!film.film.calibration) return std::nullopt;
    const ImageModel& model = film.film.calibration->model;
    // From here on in blocks.
    const Binning blocks = model.binning;
    const double a = scale / blocks.factor;
    std::vector<Vec3> spheres;
    std::vector<Vec2> truth;
    for (auto& row : grainfield::testing::csv_rows(scene / "true.csv")) {
        const Vec3 p{std::stod(row["x"]), std::stod(row["y"]), std::stod(row["z"])};
        spheres.push_back(p);
        truth.push_back(blocks.in_blocks(Vec2{p.x, p.y}));
    }
    const Image frame = source->read(0).image;
    const Image counts = blocks.binned(frame);
    const Image darkness = model.darkness(counts);
    Locator locator(counts.width(), counts.height(), model, 2);
    locator.expect_misfit(model.residual_rms);
    const Located found = locator.locate(darkness, in_blocks(options.detection, blocks),
                                         in_blocks(options.refinement, blocks));
    const Image residual = locator.residual();
    const std::vector<Vec2> errors = standard_errors(found);
    const BiasTerms terms(darkness, residual, found.fitted, a);
    const PointGrid grid(truth, kSame * a);
    std::vector<BiasTerms::Terms> rows;
    std::vector<Vec2> lacks;
    std::vector<Vec2> expected;
    std::vector<Vec2> least_expected;
    MirrorLesson lesson{.name = scene.string(),
                        .width = model.disc.edge_width / a,
                        .diameter = model.disc.diameter / a,
                        .terms = {},
                        .lacks = {},
                        .error = {},
                        .least = {},
                        .overlap = {},
                        .patterns = {}};
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        const double inside =
            std::min({p.x, p.y, counts.width() - 1 - p.x, counts.height() - 1 - p.y});
        if (inside < BiasTerms::kReach * a) continue;
        if (!std::isfinite(squared_norm(errors[i])) || !(errors[i].x > 0 && errors[i].y > 0)) {
            continue;
        }
        double least = kSame * kSame * a * a;
        std::optional<Vec2> lack;
        grid.near(p, kSame * a, [&](std::uint32_t, Vec2 q) {
            if (squared_norm(q - p) >= least) return;
            least = squared_norm(q - p);
            lack = (1 / a) * (q - p);
        });
        if (!lack) continue;
        rows.push_back(terms.of(p));
        lacks.push_back(*lack);
        expected.push_back((1 / a) * errors[i]);
        least_expected.push_back((found.noise / a) * found.error[i]);
        lesson.overlap.push_back(overlap_class(terms.nearest(p)));
    }
    if (rows.empty()) return std::nullopt;
    RandomStream random(number, "discs with a rim");
    lesson.patterns = patterns_of(lesson.name, frame, spheres, scale, options, random);
    const auto n = static_cast<Eigen::Index>(rows.size());
    lesson.terms.resize(2 * n, kTerms);
    lesson.lacks.resize(2 * n);
    lesson.error.resize(2 * n);
    lesson.least.resize(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        lesson.terms.row(i) = Eigen::Map<const Eigen::RowVectorXf>(rows[k].x.data(), kTerms);
        lesson.terms.row(n + i) = Eigen::Map<const Eigen::RowVectorXf>(rows[k].y.data(), kTerms);
        lesson.lacks(i) = lacks[k].x;
        lesson.lacks(n + i) = lacks[k].y;
        lesson.error(i) = expected[k].x;
        lesson.error(n + i) = expected[k].y;
        lesson.least(i) = least_expected[k].x;
        lesson.least(n + i) = least_expected[k].y;
    }
    return lesson;
}

}  // namespace

std::vector<MirrorLesson> lessons_in(const std::vector<std::string>& folders) {
    std::vector<MirrorLesson> lessons;
    for (const std::string& folder : folders) {
        std::vector<fs::path> scenes;
        for (const auto& entry : fs::directory_iterator(folder)) scenes.push_back(entry.path());
        std::sort(scenes.begin(), scenes.end());
        for (const fs::path& scene : scenes) {
            std::optional<MirrorLesson> lesson = lesson_of(scene, lessons.size());
            if (!lesson) {
                fmt::print(stderr, "nothing to learn from in {}\n", scene.string());
                continue;
            }
            fmt::print(stderr, "\r{} cameras", lessons.size() + 1);
            lessons.push_back(std::move(*lesson));
        }
    }
    fmt::print(stderr, "\n");
    return lessons;
}

}  // namespace grainfield::bench
