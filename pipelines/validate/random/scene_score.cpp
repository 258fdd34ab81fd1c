#include "pipelines/validate/random/scene_score.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/stored_trajectory.h"
#include "pipelines/render/rendered_frames.h"
#include "simulate/simulate.h"
#include "tracking/score/detection_scores.h"

namespace grainfield::pipelines {

namespace {

constexpr double apparent = 0.88;  // D [a]
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Class 0 of true spheres that are at least `margin` inside; the others may be matched.
std::vector<std::uint64_t> classes_of(const SeenScene& scene, double margin) {
    const double right = scene.frame.image.width() - 1 - margin;
    const double low = scene.frame.image.height() - 1 - margin;
    std::vector<std::uint64_t> classes;
    for (const Vec2 p : scene.truth.position) {
        const bool counts = p.x >= margin && p.y >= margin && p.x <= right && p.y <= low;
        classes.push_back(counts ? 1 : 0);
    }
    return classes;
}

/// Processor time of this thread [µs]: what other scenes do meanwhile does not count.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Share of the errors of both axes within twice the reported standard error.
double within_two_sigma(const SeenScene& scene, const tracking::TruthFrame& truth,
                        const std::vector<int>& partner) {
    if (scene.found.position_error.empty()) return nan;
    std::int64_t within = 0;
    std::int64_t all = 0;
    for (std::size_t i = 0; i < partner.size(); ++i) {
        if (partner[i] < 0 || truth.classes[i] == 0) continue;
        const auto j = static_cast<std::size_t>(partner[i]);
        const Vec2 error = scene.found.position[j] - truth.position[i];
        const Vec2 reported = scene.found.position_error[j];
        within += std::abs(error.x) < 2 * reported.x ? 1 : 0;
        within += std::abs(error.y) < 2 * reported.y ? 1 : 0;
        all += 2;
    }
    return all > 0 ? static_cast<double>(within) / static_cast<double>(all) : nan;
}

}  // namespace

double SceneScore::recall() const {
    return spheres > 0 ? 1 - static_cast<double>(missed) / static_cast<double>(spheres) : nan;
}

double SceneScore::false_share() const {
    return spheres > 0 ? static_cast<double>(spurious) / static_cast<double>(spheres) : nan;
}

void score_scene(SeenScene& scene) {
    const double diameter = apparent * scene.score.drawn.scale;
    const tracking::TruthFrame truth{scene.truth.position, classes_of(scene, diameter), {}};
    tracking::DetectionScores scores({"all"}, diameter / 4);
    const tracking::FrameMatch match =
        scores.add(truth, scene.found.position, scene.found.position_error);
    const tracking::ClassScore& all = scores.find("all");
    scene.score.spheres = all.matched + all.missed;
    scene.score.missed = all.missed;
    scene.score.spurious = all.spurious;
    scene.score.rmse = all.matched > 0 ? all.rmse_per_axis() / scene.score.drawn.scale : nan;
    scene.score.pull_rms = all.matched > 0 ? all.pull_rms() : nan;
    scene.score.within = within_two_sigma(scene, truth, match.partner);
    std::vector<char> is_paired(scene.found.size(), 0);
    for (std::size_t i = 0; i < match.partner.size(); ++i) {
        if (match.partner[i] >= 0) {
            is_paired[static_cast<std::size_t>(match.partner[i])] = 1;
        } else if (truth.classes[i] != 0) {
            scene.missed.push_back(truth.position[i]);
        }
    }
    for (std::size_t j = 0; j < is_paired.size(); ++j) {
        if (is_paired[j] == 0 && match.classes[j] != 0) {
            scene.spurious.push_back(scene.found.position[j]);
        }
    }
}

SeenScene see_scene(const DrawnScene& drawn, std::int64_t index,
                    const tracking::TrackOptions& tracking) {
    RunPlan own;  // what is skipped in each scene is not the plan of the whole
    StoredTrajectory layer(
        simulate::simulate_md(layer_of(drawn), {.seed = drawn.seed, .threads = 1}));
    RenderedFrames frames(layer, layer.at(0).box, camera_of(drawn), drawn.seed, 1, own);
    SeenScene scene;
    scene.score.index = index;
    scene.score.drawn = drawn;
    scene.frame = frames.read(0);
    scene.truth = frames.truth(0);

    tracking::TrackOptions options = tracking;
    options.threads = 1;
    if (!options.sphere_diameter) options.sphere_diameter = drawn.scale;
    tracking::Tracker tracker(frames, options, own);
    scene.score.is_calibrated = tracker.is_calibrated();
    scene.score.residual = scene.score.us_per_sphere = nan;
    if (scene.score.is_calibrated) {
        StoredTrajectory found;
        Progress silent("", 1, "frames", Verbosity::quiet);
        const double began = processor_time();
        const tracking::TrackSummary summary = tracker.run(found, silent);
        const double took = processor_time() - began;
        if (found.count() > 0) scene.found = found.at(0);
        scene.score.disc = tracker.model().disc;
        scene.score.residual = summary.residual_rms;
        scene.score.us_per_sphere = took / std::max(1.0, summary.particles_mean);
    }
    score_scene(scene);
    return scene;
}

std::string toml_of(const DrawnScene& drawn) {
    std::string text;
    const auto line = [&](const char* name, double value, const char* unit) {
        text += fmt::format("{} = {:.6g}  # [{}]\n", name, value, unit);
    };
    line("panel-distance", drawn.panel_distance, "a");
    line("reflectivity", drawn.reflectivity, "-");
    line("blur", drawn.blur, "a");
    line("aperture", drawn.aperture, "rad");
    line("distance", drawn.distance.value_or(0), "sides of the frame; 0: telecentric");
    line("vignetting", drawn.vignetting, "-");
    line("level", drawn.level, "saturation");
    line("noise", drawn.noise, "bright field");
    line("stray", drawn.stray, "bright field");
    text += fmt::format("scale = {:.12g}  # [px/a]\n", drawn.scale);
    line("density", drawn.density, "1/a2");
    text += fmt::format("spheres = {}\n", drawn.spheres);
    if (drawn.crystal) {
        line("crystal-share", drawn.crystal->share, "of the area");
        line("crystal-spacing", drawn.crystal->spacing, "a");
        line("crystal-periods", drawn.crystal->periods, "-");
    }
    line("amplitude", drawn.amplitude, "a");
    line("phase", drawn.phase, "periods");
    text += fmt::format("walls-seen = {}\nseed = {}\n", drawn.walls_seen, drawn.seed);
    return text;
}

}  // namespace grainfield::pipelines
