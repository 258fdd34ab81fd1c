// Positions and heights by synthesis on a frame of known truth, beside plain tracking.
//
//   bench.tracking.synthesis FRAME TRUTH.csv DIAMETER [--height H] [--height-unit PX] [--searches
//   N]
//                            [--threads N] [--synthesis no]
//
// FRAME: any image. TRUTH.csv: columns x, y [px] and z, in units of `--height-unit` (1: pixels; a:
// diameters). Spheres 2 a or more within the frame are scored. Prints a table: error per axis,
// error of the height about the mean difference, missed, false, residual, seconds and those of all
// cores together.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "io/frame_files.h"
#include "tests/support/csv_rows.h"
#include "tests/support/position_score.h"
#include "tracking/tracking.h"

namespace {

using namespace grainfield;

struct Settings {
    std::string frame, truth;
    double diameter = 0;     ///< a [px]
    double height_unit = 1;  ///< [px]
    bool without_synthesis = false;
    tracking::TrackOptions options;
};

Settings settings_of(const std::vector<std::string>& words) {
    if (words.size() < 3 || words.size() % 2 == 0) {
        throw std::invalid_argument("give FRAME TRUTH.csv DIAMETER and pairs of option and value");
    }
    Settings s;
    s.frame = words[0];
    s.truth = words[1];
    s.diameter = std::stod(words[2]);
    for (std::size_t i = 3; i < words.size(); i += 2) {
        const std::string& value = words[i + 1];
        if (words[i] == "--height") {
            s.options.layers.height = std::stod(value);
        } else if (words[i] == "--height-unit") {
            s.height_unit = std::stod(value);
        } else if (words[i] == "--searches") {
            s.options.synthesis_options.searches = std::stoi(value);
        } else if (words[i] == "--synthesis") {
            s.without_synthesis = value == "no";
        } else if (words[i] == "--threads") {
            s.options.threads = std::stoi(value);
        } else {
            throw std::invalid_argument("no option " + words[i]);
        }
    }
    s.options.sphere_diameter = s.diameter;
    return s;
}

struct Truth {
    std::vector<Vec2> position;  ///< [px]
    std::vector<double> z;       ///< [a]
};

Truth truth_of(const Settings& s) {
    Truth truth;
    for (auto& row : grainfield::testing::csv_rows(s.truth)) {
        truth.position.push_back({std::stod(row["x"]), std::stod(row["y"])});
        truth.z.push_back(std::stod(row["z"]) * s.height_unit / s.diameter);
    }
    return truth;
}

/// Of absolute errors.
struct Spread {
    double rms = 0, median = 0, p99 = 0;
};

Spread spread_of(std::vector<double> errors) {
    if (errors.empty()) return {};
    Spread spread;
    for (double& e : errors) {
        e = std::abs(e);
        spread.rms += e * e;
    }
    spread.rms = std::sqrt(spread.rms / static_cast<double>(errors.size()));
    std::ranges::sort(errors);
    spread.median = errors[errors.size() / 2];
    spread.p99 = errors[errors.size() * 99 / 100];
    return spread;
}

void print_line(const char* name, const Settings& s, const Truth& truth, const Frame& frame,
                const Snapshot& found, const tracking::TrackSummary& summary, double seconds,
                double cpu) {
    const double a = s.diameter;
    const int width = frame.image.width();
    const int height = frame.image.height();
    const auto score = grainfield::testing::score_positions(found.position, truth.position, 0.5 * a,
                                                            width, height, 2 * a);
    std::vector<double> plane;
    std::vector<double> vertical;
    int within = 0;
    int within_height = 0;
    std::vector<double> height_error;
    for (std::size_t i = 0; i < truth.position.size(); ++i) {
        const Vec2 p = truth.position[i];
        const bool is_inner = std::min({p.x, p.y, width - 1 - p.x, height - 1 - p.y}) >= 2 * a;
        if (score.partner[i] < 0 || !is_inner) continue;
        const auto j = static_cast<std::size_t>(score.partner[i]);
        const Vec2 off = (1 / a) * (found.position[j] - p);
        plane.insert(plane.end(), {off.x, off.y});
        within += std::abs(off.x) * a < 2 * found.position_error[j].x;
        within += std::abs(off.y) * a < 2 * found.position_error[j].y;
        if (found.z.empty()) continue;
        vertical.push_back(found.z[j] / a - truth.z[i]);
        height_error.push_back(found.z_error[j] / a);
    }
    double mean = 0;
    for (const double v : vertical) mean += v / static_cast<double>(vertical.size());
    for (std::size_t i = 0; i < vertical.size(); ++i) {
        vertical[i] -= mean;
        within_height += std::abs(vertical[i]) < 2 * height_error[i];
    }
    const Spread xy = spread_of(plane);
    const Spread z = spread_of(vertical);
    const auto& synthesis = summary.synthesis;
    fmt::print(
        "| {} | {} | {} | {} | {:.4f} | {:.4f} | {:.3f} | {:.1f} % | {:.3f} | {:.3f} | "
        "{:.3f} | {:.1f} % | {:.4f} → {:.4f} | {:.1f} | {:.1f} |\n",
        name, score.matched, score.missed, score.spurious, xy.rms, xy.median, xy.p99,
        100.0 * within / static_cast<double>(std::max<std::size_t>(1, plane.size())), z.rms,
        z.median, z.p99,
        100.0 * within_height / static_cast<double>(std::max<std::size_t>(1, vertical.size())),
        synthesis.mean_before(),
        synthesis.frames > 0 ? synthesis.mean_after() : summary.residual_rms, seconds, cpu);
    if (synthesis.frames > 0) {
        fmt::print("\n{} added, {} removed, {} moved, {} doubtful; {}\n", synthesis.added,
                   synthesis.removed, synthesis.lifted, synthesis.doubtful,
                   in_words(synthesis.optics, synthesis.optics_error));
    }
}

/// Keeps the one snapshot.
class Keep : public SnapshotSink {
 public:
    void write(const Snapshot& snapshot) override { kept = snapshot; }
    Snapshot kept;
};

void run(Settings s) {
    const Truth truth = truth_of(s);
    fmt::print(
        "| | matched | missed | false | rms x, y [a] | median | p99 | within 2σ | rms z [a] | "
        "median | p99 | within 2σ | residual | seconds | CPU seconds |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const char* method : {"discs", "general", "learned", "synthesis"}) {
        const std::string name = method;
        if (name == "synthesis" && s.without_synthesis) continue;
        auto frames = io::open_frames({s.frame}, {});
        s.options.synthesis = name == "synthesis";
        s.options.correct_bias = name == "learned";
        if (name == "general" || name == "synthesis") s.options.correct_bias.reset();
        Keep sink;
        const auto begin = std::chrono::steady_clock::now();
        const std::clock_t cpu_begin = std::clock();
        RunPlan plan;
        const tracking::TrackSummary summary =
            tracking::track(*frames, sink, s.options, {.plan = &plan});
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        const double cpu = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
        print_line(method, s, truth, frames->read(0), sink.kept, summary, taken.count(), cpu);
        for (const PlannedStage& stage : plan.stages()) {
            if (stage.stage == "bias") fmt::print(stderr, "{}: {}\n", method, stage.reason);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(settings_of({argv + 1, argv + argc}));
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
