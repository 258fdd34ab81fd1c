#include "pipelines/validate/random/random_report.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pipelines/validate/threshold_table.h"
#include "report/figures/figure_source.h"

namespace grainfield::pipelines {

namespace {

using report::Table;
using report::TableCell;

TableCell number(double value, const char* format = "{:.3g}") {
    if (!std::isfinite(value)) return {};
    return {value, fmt::format(fmt::runtime(format), value), false};
}

TableCell count(std::int64_t value) {
    return {static_cast<double>(value), fmt::format("{}", value), false};
}

const char* format_of(const SceneQuantity& quantity) {
    if (quantity.key == "recall") return "{:.5f}";
    return quantity.key == "us_per_sphere" ? "{:.0f}" : "{:.4f}";
}

Table summary_table(const std::vector<SceneScore>& scenes) {
    Table table;
    table.name = "random_summary";
    table.title = "Over all cameras";
    table.note = fmt::format(
        "{} scenes. True spheres at least D inside the frame, pairs within D/4, D = 0.88 a. RMSE "
        "per axis. Pull: error over reported standard error, RMS; within 2σ should be 0.954.",
        scenes.size());
    table.columns = {{"median", "Median", ""}, {"worst", "Worst", ""}};
    for (const SceneQuantity& q : scene_quantities()) {
        const SceneSpread spread = spread_of(scenes, q);
        table.rows.push_back(
            {q.unit.empty() ? q.label : q.label + " [" + q.unit + "]",
             {number(spread.median, format_of(q)), number(spread.worst, format_of(q))}});
    }
    return table;
}

Table scene_table(const std::vector<SceneScore>& scenes) {
    Table table;
    table.name = "random_scenes";
    table.title = "The scenes";
    table.note =
        "Panel below the cell, reflectance of the spheres, blur, half angle of the lens, distance "
        "of the pinhole in sides of the frame (none: telecentric), vignetting, bright field over "
        "saturation, photon noise; D and w as calibrated. Processor time of a cold frame after "
        "calibration.";
    table.columns = {{"spheres", "True", ""},
                     {"missed", "Missed", ""},
                     {"false", "False", ""},
                     {"rmse_a", "RMSE", "a"},
                     {"pull_rms", "Pull", ""},
                     {"within_2_sigma", "Within 2σ", ""},
                     {"residual_rms", "Residual", "contrast"},
                     {"us_per_sphere", "Time", "µs"},
                     {"panel", "Panel", "a"},
                     {"reflectivity", "Mirror", ""},
                     {"blur", "Blur", "a"},
                     {"aperture", "Lens", "rad"},
                     {"distance", "Pinhole", ""},
                     {"vignetting", "Vignetting", ""},
                     {"level", "Level", ""},
                     {"noise", "Noise", ""},
                     {"scale", "Scale", "px/a"},
                     {"density", "Density", "1/a²"},
                     {"diameter", "D", "px"},
                     {"edge_width", "w", "px"}};
    for (const SceneScore& s : scenes) {
        const DrawnScene& d = s.drawn;
        table.rows.push_back({fmt::format("{}", s.index),
                              {count(s.spheres),
                               count(s.missed),
                               count(s.spurious),
                               number(s.rmse, "{:.4f}"),
                               number(s.pull_rms, "{:.2f}"),
                               number(s.within, "{:.2f}"),
                               number(s.residual, "{:.3f}"),
                               number(s.us_per_sphere, "{:.0f}"),
                               number(d.panel_distance),
                               number(d.reflectivity, "{:.2f}"),
                               number(d.blur, "{:.3f}"),
                               number(d.aperture, "{:.3f}"),
                               d.distance ? number(*d.distance, "{:.0f}") : TableCell{},
                               number(d.vignetting, "{:.2f}"),
                               number(d.level, "{:.2f}"),
                               number(d.noise, "{:.3f}"),
                               number(d.scale, "{:.1f}"),
                               number(d.density, "{:.2f}"),
                               number(s.disc.diameter, "{:.2f}"),
                               number(s.disc.edge_width, "{:.2f}")}});
    }
    return table;
}

report::Figure time_figure(const std::vector<SceneScore>& scenes) {
    report::Figure figure = report::empty_figure(
        {"scenes"}, "random_time_error", "Time against error",
        {"time", "Time a sphere", "µs", Scale::log, true},
        {"rmse", "RMS error per axis", "a", Scale::log, true},
        "One point a scene, in the order of their times; processor time, without a start.");
    std::vector<const SceneScore*> order;
    for (const SceneScore& s : scenes) {
        if (std::isfinite(s.rmse) && std::isfinite(s.us_per_sphere)) order.push_back(&s);
    }
    std::sort(order.begin(), order.end(),
              [](const auto* a, const auto* b) { return a->us_per_sphere < b->us_per_sphere; });
    report::Series series{0, 0, {}, {}, {}};
    for (const SceneScore* s : order) {
        series.x.push_back(s->us_per_sphere);
        series.y.push_back(s->rmse);
    }
    figure.kinds.push_back({"scenes", Mark::line, true});
    if (!series.x.empty()) figure.series.push_back(std::move(series));
    return figure;
}

/// A frame with marks at `positions` alone.
Preview preview_of(const SeenScene& scene, const std::vector<Vec2>& positions) {
    Preview preview;
    preview.frame = scene.frame;
    preview.frame.index = scene.score.index;
    preview.snapshot.frame = scene.score.index;
    preview.snapshot.position = positions;
    preview.snapshot.box = scene.truth.box;
    return preview;
}

}  // namespace

report::ReportAdditions random_report(const std::vector<SceneScore>& scenes,
                                      const std::vector<ThresholdCheck>& checks) {
    report::ReportAdditions additions;
    if (!checks.empty()) additions.tables.push_back(threshold_table(checks));
    additions.tables.push_back(summary_table(scenes));
    additions.tables.push_back(scene_table(scenes));
    additions.figures.push_back(time_figure(scenes));
    return additions;
}

std::vector<Results> random_runs(const std::vector<SceneScore>& scenes,
                                 const std::vector<SeenScene>& worst) {
    std::vector<Results> runs(3);
    runs[0].label = "missed";
    runs[1].label = "false";
    runs[2].label = "found";
    for (const SeenScene& scene : worst) {
        runs[0].previews.push_back(preview_of(scene, scene.missed));
        runs[1].previews.push_back(preview_of(scene, scene.spurious));
        runs[2].previews.push_back(preview_of(scene, scene.found.position));
    }
    for (Results& run : runs) {
        run.source.origin = Origin::rendered;
        run.source.length_unit = LengthUnit::pixel;
        run.source.diameter_origin = DiameterOrigin::simulated;
        if (!worst.empty()) run.source.diameter = worst.front().score.drawn.scale;
        run.identity = identity_of(run.source);
        run.frames = static_cast<std::int64_t>(scenes.size());
    }
    for (const SceneScore& s : scenes) {
        const auto all = static_cast<double>(scenes.size());
        runs[0].particles_mean += static_cast<double>(s.missed) / all;
        runs[1].particles_mean += static_cast<double>(s.spurious) / all;
        runs[2].particles_mean += static_cast<double>(s.spheres - s.missed + s.spurious) / all;
    }
    return runs;
}

}  // namespace grainfield::pipelines
