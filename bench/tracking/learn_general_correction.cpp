// Learns how discs err on mirror-like spheres from frames of many cameras (GeneralCorrection).
//
//   grainfield validate --optics random --scenes 20 --seed 101 --keep FRAMES -o page.html
//   grainfield validate --optics random --scenes 20 --seed 201 --crystals 1 --keep FRAMES …
//   bench.tracking.learn_general_correction general_correction.txt FRAMES…
//
// FRAMES: folders that `validate --keep` wrote: frame.png, true.csv and optics.toml of each scene.
// Each frame is calibrated and searched as `track` does it. What mirrors look like is learned from
// them, and what discs with a rim look like from frames of such discs in the same places
// (rimmed_discs). Every fourth camera is left out in
// turn: the table that is printed, the shares of the errors that remain, the doubt and the ridge
// are of cameras left out. The weights are of all.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/tracking/mirror_lessons.h"
#include "bench/tracking/mirror_patterns.h"
#include "bench/tracking/mirror_regression.h"
#include "bench/tracking/share_of_values.h"
#include "core/errors.h"
#include "tracking/synthesis/general_correction.h"

namespace {

using namespace grainfield;
using namespace grainfield::bench;
using tracking::GeneralCorrection;

/// Two in each fold.
constexpr std::size_t kLeastCameras = 2 * kFolds;

void require_cameras(std::size_t count) {
    if (count >= kLeastCameras) return;
    throw InputError({.problem = "too few cameras to learn from",
                      .actual = fmt::format("{} that can be calibrated", count),
                      .expected = fmt::format("{} at least", kLeastCameras),
                      .suggestion = "give folders of more scenes (validate --keep)"});
}

GeneralCorrection general_of(const std::vector<MirrorLesson>& lessons,
                             const MirrorRegression& regression,
                             const std::vector<CameraPatterns>& patterns) {
    GeneralCorrection general;
    general.weights = regression.weights;
    general.shares = regression.errors.shares;
    general.doubt = regression.errors.doubt;
    std::vector<double> before, after, widths, diameters;
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        before.push_back(regression.cameras[k].before);
        after.push_back(regression.cameras[k].after);
        widths.push_back(lessons[k].width);
        diameters.push_back(lessons[k].diameter);
        general.spheres += static_cast<int>(lessons[k].spheres());
    }
    general.cameras = static_cast<int>(lessons.size());
    general.before = quantile(before, 0.5);
    general.after = quantile(after, 0.5);
    general.least_width = *std::min_element(widths.begin(), widths.end());
    general.most_width = *std::max_element(widths.begin(), widths.end());
    general.least_diameter = *std::min_element(diameters.begin(), diameters.end());
    general.most_diameter = *std::max_element(diameters.begin(), diameters.end());
    describe_patterns(patterns, kFolds, general);
    return general;
}

void write(const GeneralCorrection& general, const std::string& output) {
    std::ofstream file(output);
    file << write_general_correction(general) << std::flush;
    if (!file) throw OutputError("cannot write " + output);
}

void print_cameras(const std::vector<MirrorLesson>& lessons, const MirrorRegression& regression) {
    fmt::print("camera | spheres | w [a] | D [a] | rms of discs [a] | corrected | within 2σ\n");
    for (std::size_t k = 0; k < lessons.size(); ++k) {
        const MirrorLesson& lesson = lessons[k];
        const CameraErrors& errors = regression.cameras[k];
        fmt::print("{} | {} | {:.3f} | {:.3f} | {:.4f} | {:.4f} | {:.3f}\n", lesson.name,
                   lesson.spheres(), lesson.width, lesson.diameter, errors.before, errors.after,
                   errors.within);
    }
}

/// The file is written before anything is printed: a reader of the tables that goes away leaves it
/// whole.
void learn(const std::string& output, const std::vector<std::string>& folders) {
    const std::vector<MirrorLesson> lessons = lessons_in(folders);
    std::vector<CameraPatterns> patterns;
    for (const MirrorLesson& lesson : lessons) patterns.push_back(lesson.patterns);
    require_cameras(lessons.size());
    require_enough(patterns);
    const MirrorRegression regression = regress(lessons);
    const GeneralCorrection general = general_of(lessons, regression, patterns);
    write(general, output);
    print_cameras(lessons, regression);
    print_patterns(patterns);
    fmt::print("{} cameras: median {:.4f} to {:.4f} a; ridge {:g}\n", lessons.size(),
               general.before, general.after, regression.ridge);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc < 3) throw std::invalid_argument("give an output file and folders of scenes");
        learn(argv[1], {argv + 2, argv + argc});
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
