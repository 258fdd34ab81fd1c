// Run time against error of finding spheres, on frames whose truth is known: one row of CSV for
// each frame, setting and class of spheres. `--quick` does small frames in seconds and fails if
// easy ones are not tracked at the bound, or if the image models do not stand in their order;
// `--many` does 40,000 spheres; `--options A,B` sweeps only these options, `--fits` only the fits
// of known spheres (fit_run.h). Plots and tables: bench/tracking/work-precision.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "bench/tracking/fit_run.h"
#include "bench/tracking/known_frames.h"
#include "bench/tracking/tracker_run.h"
#include "tracking/score/edge_noise.h"
#include "tracking/score/position_bounds.h"

namespace {

using namespace grainfield;
using namespace grainfield::bench;
using namespace grainfield::tracking;

using Runs = std::vector<std::unique_ptr<TimedRun>>;
using Setting = std::pair<std::string, std::string>;  // an option and its value

/// Gives the frame its bounds; returns the noise that they are for [contrast].
double add_bounds(KnownFrame& frame, const FrameSpec& spec, const ImageModel& model) {
    double noise = edge_noise(frame.counts, model, frame.truth.position);
    if (!(noise > 0)) noise = spec.noise;  // edges everywhere
    frame.truth.bound = position_bounds(frame.truth.position, model.disc, frame.counts.width(),
                                        frame.counts.height(), noise, 2);
    return noise;
}

/// They take turns, so that a disturbance of the machine meets all of them.
void take_turns(const Runs& runs, int turns) {
    for (int turn = 0; turn < turns; ++turn) {
        for (const auto& run : runs) run->take_turn();
    }
}

void print(const std::string& group, const FrameSpec& spec, double noise, const TruthFrame& truth,
           const Runs& runs) {
    for (const auto& run : runs) {
        run->print(group, spec, noise, run->score(truth, spec.diameter / 4), *runs.front());
    }
}

std::optional<Calibration> usual_calibration(const std::string& group, const FrameSpec& spec,
                                             const TrackerRun& run) {
    if (!run.calibration()) {
        fmt::print(stderr, "{}, {}, D = {:g} px, noise {:g}: not calibrated\n", group, spec.scene(),
                   spec.diameter, spec.noise);
    }
    return run.calibration();
}

/// The defaults and the settings. False if the first one misses or invents a sphere, or is far from
/// the bound where it should not be: on frames of the tracker's own kind and on spheres that touch
/// no other.
bool measure(const std::string& group, const FrameSpec& spec, const std::vector<Setting>& settings,
             int turns) {
    KnownFrame frame = make_frame(spec);
    auto defaults = std::make_unique<TrackerRun>(frame, "default", "-");
    const std::optional<Calibration> usual = usual_calibration(group, spec, *defaults);
    if (!usual) return false;
    Runs runs;
    runs.push_back(std::move(defaults));
    const double noise = add_bounds(frame, spec, usual->model);
    for (const auto& [option, value] : settings) {
        runs.push_back(std::make_unique<TrackerRun>(frame, option, value, &*usual));
    }
    take_turns(runs, turns);
    print(group, spec, noise, frame.truth, runs);
    const DetectionScores scores = runs.front()->score(frame.truth, spec.diameter / 4);
    const ClassScore& all = scores.find("all");
    const bool is_known = spec.camera == CameraModel::own || spec.matter == Matter::isolated;
    return all.missed + all.spurious == 0 && (!is_known || all.bound_ratio() < 1.5);
}

/// Fits of known spheres. False if the product of transmissions is not at the bound on the frame,
/// which is then one of its own kind, or the sum of darknesses is not five times worse.
bool measure_fits(const std::string& group, const FrameSpec& spec, int turns) {
    KnownFrame frame = make_frame(spec);
    const TrackerRun defaults(frame, "default", "-");
    const std::optional<Calibration> usual = usual_calibration(group, spec, defaults);
    if (!usual) return false;
    const double noise = add_bounds(frame, spec, usual->model);
    const Image darkness = usual->model.darkness(frame.counts);
    const std::vector<Vec2> start = displaced(frame.truth.position, spec.diameter);
    const Runs runs = fit_runs(darkness, usual->model.disc, start);
    take_turns(runs, turns);
    print(group, spec, noise, frame.truth, runs);
    const auto all = [&](std::size_t run) {
        return runs[run]->score(frame.truth, spec.diameter / 4).find("all");
    };
    return all(0).bound_ratio() < 1.5 && all(2).rmse_per_axis() > 5 * all(0).rmse_per_axis();
}

/// What is swept where `--options` names nothing: what a user can turn, and the control.
constexpr const char* kUsualOptions =
    "tolerance,max-sweeps,separation,evidence,uniform-tolerance,size,meeting-edges,profile,control,"
    "start,threads";

/// `only`: comma list of options.
std::vector<Setting> settings_of(const std::string& only) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> sweeps{
        {"tolerance", {"0.001", "0.01", "0.03", "0.1", "0.3"}},
        {"max-sweeps", {"1", "2", "3", "6", "30"}},
        {"max-passes", {"1", "2", "3", "4"}},
        {"cutoff", {"1.5", "2", "5", "10"}},
        {"separation", {"0.25", "0.6"}},
        {"evidence", {"0.02", "0.05", "0.25"}},
        {"significance", {"0", "3", "12", "25"}},
        {"uniform-tolerance", {"1"}},
        {"size", {"given"}},
        {"meeting-edges", {"auto", "product", "blurred-union"}},
        {"profile", {"auto", "tanh", "learned"}},
        {"control", {"default"}},
        {"start", {"warm"}},
        {"threads", {"2"}}};
    std::vector<Setting> settings;
    for (const auto& [option, values] : sweeps) {
        if (("," + only + ",").find("," + option + ",") == std::string::npos) continue;
        for (const std::string& value : values) settings.emplace_back(option, value);
    }
    return settings;
}

void sweep_options(const std::string& only) {
    const std::vector<Setting> settings = settings_of(only);
    for (const CameraModel camera : {CameraModel::own, CameraModel::silhouette}) {
        FrameSpec spec;
        spec.camera = camera;
        std::vector<FrameSpec> frames(4, spec);
        frames[1].noise = 0.1;
        frames[2].matter = Matter::patch;
        frames[2].density = 0.75;
        frames[3].diameter = 6;
        frames[3].edge = 0.12;
        frames[3].noise = 0.05;
        for (const FrameSpec& f : frames) measure("options", f, settings, 3);
    }
}

/// Fits of known spheres: a liquid, a crystal patch of usual and one of small spacing, and small
/// discs; frames of 24 D (40 D for the small ones).
void sweep_fits() {
    for (const CameraModel camera : {CameraModel::own, CameraModel::silhouette}) {
        FrameSpec spec;
        spec.camera = camera;
        spec.side = 24;
        std::vector<FrameSpec> frames(4, spec);
        frames[1].matter = frames[2].matter = Matter::patch;
        frames[1].density = 0.8;
        frames[2].density = 0.75;
        frames[3].diameter = 6;
        frames[3].edge = 0.12;
        frames[3].noise = 0.05;
        frames[3].side = 40;
        for (const FrameSpec& f : frames) measure_fits("fits", f, 3);
    }
}

/// The three scenes, each from both cameras, with one property changed.
template <class Value, class Change>
void sweep(const std::string& group, const std::vector<Value>& values, Change&& change) {
    const std::vector<std::pair<Matter, double>> scenes{
        {Matter::isolated, 0}, {Matter::liquid, 0.72}, {Matter::patch, 0.78}};
    for (const CameraModel camera : {CameraModel::own, CameraModel::silhouette}) {
        for (const auto& [matter, density] : scenes) {
            for (const Value& value : values) {
                FrameSpec spec;
                spec.camera = camera;
                spec.matter = matter;
                spec.density = density;
                if (change(spec, value)) measure(group, spec, {{"start", "warm"}}, 3);
            }
        }
    }
}

void sweep_frames() {
    using Numbers = std::vector<double>;
    sweep("noise", Numbers{0.005, 0.01, 0.02, 0.05, 0.1}, [](FrameSpec& spec, double noise) {
        spec.noise = noise;
        return true;
    });
    sweep("diameter", Numbers{6, 8, 10, 16, 24, 40}, [](FrameSpec& spec, double diameter) {
        spec.diameter = diameter;
        if (diameter > 20) spec.side = 30;
        return true;
    });
    sweep("density", Numbers{0, 0.1, 0.3, 0.5, 0.72, 0.81, 0.78, 0.75},
          [](FrameSpec& spec, double density) {
              spec.density = density;
              if (spec.matter == Matter::isolated) return density == 0;
              return spec.matter == Matter::liquid ? density > 0 && density < 0.73 : density > 0.73;
          });
    sweep("defocus", Numbers{0.03, 0.075, 0.12, 0.2, 0.3}, [](FrameSpec& spec, double edge) {
        spec.edge = edge;
        return spec.matter != Matter::isolated;
    });
    sweep("exposure", Numbers{0, 0.02, 0.05, 0.1, 0.2}, [](FrameSpec& spec, double path) {
        spec.path = path;
        return spec.camera == CameraModel::silhouette && spec.matter != Matter::isolated;
    });
}

/// As many spheres as a frame may hold, and what that takes.
void many() {
    for (const CameraModel camera : {CameraModel::own, CameraModel::silhouette}) {
        FrameSpec spec;
        spec.camera = camera;
        spec.diameter = 10;
        spec.side = 210;
        measure("many", spec, {{"start", "warm"}}, 3);
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print(stderr, "peak memory of the program: {} MB\n", usage.ru_maxrss / 1024);
}

bool quick() {
    bool good = true;
    for (const CameraModel camera : {CameraModel::own, CameraModel::silhouette}) {
        for (const Matter matter : {Matter::isolated, Matter::liquid}) {
            FrameSpec spec;
            spec.camera = camera;
            spec.matter = matter;
            spec.density = 0.6;
            spec.diameter = 12;
            spec.side = 20;
            good &= measure("quick", spec, {{"start", "warm"}, {"max-sweeps", "2"}}, 1);
        }
    }
    FrameSpec spec;
    spec.camera = CameraModel::own;
    spec.matter = Matter::patch;
    spec.density = 0.8;
    spec.side = 16;
    good &= measure_fits("quick fits", spec, 1);
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "";
    TimedRun::print_head();
    if (what == "--quick") return quick() ? 0 : 1;
    if (what == "--many") {
        many();
    } else if (what == "--fits") {
        sweep_fits();
    } else if (what == "--options") {
        sweep_options(argc > 2 ? argv[2] : kUsualOptions);
    } else {
        sweep_frames();
        sweep_options(kUsualOptions);
        sweep_fits();
        many();
    }
    return 0;
}
