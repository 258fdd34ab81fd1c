// Run time against error of finding spheres, on frames whose truth is known: one row of CSV for
// each frame, setting and class of spheres. `--quick` does small frames in seconds and fails if
// easy ones are not tracked at the bound; `--many` does 40,000 spheres; `--options A,B` sweeps only
// these options. Plots and tables: bench/tracking/work-precision.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "bench/tracking/known_frames.h"
#include "core/run_plan.h"
#include "tracking/score/edge_noise.h"
#include "tracking/score/position_bounds.h"
#include "tracking/tracker.h"

namespace {

using namespace grainfield;
using namespace grainfield::bench;
using namespace grainfield::tracking;

double processor_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/// One option away from the defaults. Besides those of `track`: "start" (cold, warm), "threads",
/// "size" (given: D and w of the default calibration are told) and "control" (the defaults once
/// more: how much times scatter that should be the same).
struct Setting {
    std::string option = "default";
    std::string value = "-";
};

/// The tracker with one setting on one frame.
class Run {
 public:
    /// `usual`: the calibration with default options, where there is one.
    Run(const KnownFrame& frame, Setting setting, const Calibration* usual = nullptr)
        : frame_(frame), setting_(std::move(setting)) {
        options_.threads = 1;
        apply(usual);
        if (usual != nullptr && !calibrates()) {
            calibration_ = *usual;
        } else {
            calibrate_anew();
        }
        if (!calibration_) return;
        locator_.emplace(frame.counts.width(), frame.counts.height(), calibration_->model.disc,
                         options_.threads, calibration_->model.meeting);
        if (setting_.value == "warm") start_ = locate(frame.before).fitted;
    }

    const std::optional<Calibration>& calibration() const { return calibration_; }

    void take_turn() {
        if (!calibration_) return;
        const auto wall = std::chrono::steady_clock::now();
        const double begin = processor_ms();
        found_ = locate(frame_.counts);
        cpu_.push_back(processor_ms() - begin);
        wall_.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall)
                .count());
    }

    DetectionScores score(const TruthFrame& truth, double gate) const {
        DetectionScores scores({"all", "crystal"}, gate);
        std::vector<Vec2> errors = found_.error;
        for (std::size_t j = 0; j < errors.size(); ++j) {
            errors[j] *= std::max(found_.noise, found_.residual[j]);
        }
        scores.add(truth, found_.position, errors);
        return scores;
    }

    /// Processor time over that of `usual` in the same turn: least, median, most.
    std::array<double, 3> ratios(const Run& usual) const {
        std::vector<double> ratio;
        for (std::size_t turn = 0; turn < cpu_.size(); ++turn) {
            ratio.push_back(cpu_[turn] / usual.cpu_[turn]);
        }
        if (ratio.empty()) return {median({}), median({}), median({})};
        const auto [least, most] = std::minmax_element(ratio.begin(), ratio.end());
        return {*least, median(ratio), *most};
    }

    void print(const std::string& group, const FrameSpec& spec, double noise,
               const DetectionScores& scores, const Run& usual) const {
        const double cpu = median(cpu_);
        const auto [least, middle, most] = ratios(usual);
        const auto spheres = static_cast<double>(found_.position.size());
        for (const ClassScore& s : scores.classes()) {
            if (s.name != "all" && spec.matter != Matter::patch) continue;
            fmt::print(
                "{},{},{},{:g},{:g},{:g},{:g},{:.4f},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},"
                "{:.3f},{:.2f},"
                "{:.2f},{:.6f},{},{},{:.6f},{:.6f},{:.6f},{:.4f},{:.3f}\n",
                group, spec.camera == CameraModel::own ? "own" : "silhouette", spec.scene(),
                spec.diameter, spec.noise, spec.edge, spec.path, noise, setting_.option,
                setting_.value, s.name, found_.position.size(), cpu, least, middle, most,
                median(wall_), 1e3 * cpu / spheres, calibrate_ms_, s.recall(), s.missed, s.spurious,
                s.rmse().x, s.rmse().y, s.bound(), s.bound_ratio(), s.pull_rms());
        }
        std::fflush(stdout);
    }

 private:
    bool calibrates() const {
        return setting_.option != "start" && setting_.option != "threads" &&
               setting_.option != "control";
    }

    void calibrate_anew() {
        const double begin = processor_ms();
        RunPlan plan;
        calibration_ = calibrate(frame_.before, options_.calibration, options_.detection,
                                 options_.refinement, options_.threads, plan);
        calibrate_ms_ = processor_ms() - begin;
    }

    void apply(const Calibration* usual) {
        if (setting_.option == "default" || setting_.option == "start" ||
            setting_.option == "control") {
            return;
        }
        if (setting_.option == "threads") {
            options_.threads = std::stoi(setting_.value);
            return;
        }
        if (setting_.option == "size") {
            options_.calibration.diameter = usual->model.disc.diameter;
            options_.calibration.edge_width = usual->model.disc.edge_width;
            return;
        }
        // No options of the program: nobody gains by them (docs/decisions.md).
        if (setting_.option == "cutoff") {
            options_.detection.cutoff = std::stod(setting_.value);
            return;
        }
        if (setting_.option == "significance") {
            options_.detection.significance = std::stod(setting_.value);
            return;
        }
        if (setting_.option == "max-passes") {
            options_.detection.max_passes = std::stoi(setting_.value);
            return;
        }
        for (const OptionTable& table : describe(options_)) {
            if (const Option* option = table.find(setting_.option)) {
                option->set_from_text(setting_.value);
                return;
            }
        }
        throw std::logic_error("no option " + setting_.option);
    }

    Located locate(const Image& counts) {
        return locator_->locate(calibration_->model.darkness(counts), options_.detection,
                                options_.refinement, start_);
    }

    const KnownFrame& frame_;
    Setting setting_;
    TrackOptions options_;
    double calibrate_ms_ = 0;
    std::optional<Calibration> calibration_;
    std::optional<Locator> locator_;
    std::vector<Vec2> start_;
    Located found_;
    std::vector<double> cpu_, wall_;
};

/// The defaults and the settings. They take turns, so that a disturbance of the machine meets all
/// of them. False if the first one misses or invents a sphere, or is far from the bound where it
/// should not be: on frames of the tracker's own kind and on spheres that touch no other.
bool measure(const std::string& group, const FrameSpec& spec, const std::vector<Setting>& settings,
             int turns) {
    KnownFrame frame = make_frame(spec);
    std::vector<Run> runs;
    runs.reserve(settings.size() + 1);
    runs.emplace_back(frame, Setting{});
    const std::optional<Calibration> usual = runs[0].calibration();
    if (!usual) {
        fmt::print(stderr, "{}, {}, D = {:g} px, noise {:g}: not calibrated\n", group, spec.scene(),
                   spec.diameter, spec.noise);
        return false;
    }
    const ImageModel& model = usual->model;
    double noise = edge_noise(frame.counts, model, frame.truth.position);
    if (!(noise > 0)) noise = spec.noise;  // edges everywhere
    frame.truth.bound = position_bounds(frame.truth.position, model.disc, frame.counts.width(),
                                        frame.counts.height(), noise, 2);
    for (const Setting& s : settings) runs.emplace_back(frame, s, &*usual);
    for (int turn = 0; turn < turns; ++turn) {
        for (Run& run : runs) run.take_turn();
    }
    for (const Run& run : runs) {
        run.print(group, spec, noise, run.score(frame.truth, spec.diameter / 4), runs.front());
    }
    const DetectionScores scores = runs.front().score(frame.truth, spec.diameter / 4);
    const ClassScore& all = scores.find("all");
    const bool is_known = spec.camera == CameraModel::own || spec.matter == Matter::isolated;
    return all.missed + all.spurious == 0 && (!is_known || all.bound_ratio() < 1.5);
}

std::vector<Setting> option_settings() {
    const std::vector<std::pair<std::string, std::vector<std::string>>> sweeps{
        {"tolerance", {"0.0003", "0.001", "0.003", "0.01", "0.03", "0.1", "0.3"}},
        {"max-sweeps", {"1", "2", "3", "4", "6", "10", "30"}},
        {"max-passes", {"1", "2", "3", "4"}},
        {"cutoff", {"1.5", "2", "5", "10", "30"}},
        {"separation", {"0.25", "0.34", "0.5", "0.6"}},
        {"evidence", {"0.02", "0.05", "0.1", "0.25", "0.4"}},
        {"significance", {"0", "3", "12", "25"}},
        {"uniform-tolerance", {"0", "0.03", "1"}},
        {"size", {"given"}},
        {"meeting-edges", {"auto", "product", "blurred-union"}},
        {"control", {"default"}},
        {"start", {"warm"}},
        {"threads", {"2"}}};
    std::vector<Setting> settings;
    for (const auto& [option, values] : sweeps) {
        for (const std::string& value : values) settings.push_back({option, value});
    }
    return settings;
}

/// `only`: comma list of options; empty: all.
void sweep_options(const std::string& only) {
    std::vector<Setting> settings = option_settings();
    if (!only.empty()) {
        std::erase_if(settings, [&](const Setting& s) {
            return ("," + only + ",").find("," + s.option + ",") == std::string::npos;
        });
    }
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
        for (const FrameSpec& f : frames) measure("options", f, settings, 5);
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
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    fmt::print(
        "group,camera,scene,diameter,noise,edge,path,noise_seen,option,value,class,spheres,cpu_ms,"
        "ratio_low,ratio,ratio_high,wall_ms,cpu_us_per_sphere,calibrate_ms,recall,missed,false,"
        "rmse_x,rmse_y,"
        "bound,over_bound,pull\n");
    if (argc > 1 && std::strcmp(argv[1], "--quick") == 0) return quick() ? 0 : 1;
    if (argc > 1 && std::strcmp(argv[1], "--many") == 0) {
        many();
        return 0;
    }
    if (argc > 2 && std::strcmp(argv[1], "--options") == 0) {
        sweep_options(argv[2]);
        return 0;
    }
    sweep_frames();
    sweep_options("");
    return 0;
}
