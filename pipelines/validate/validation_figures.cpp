#include "pipelines/validate/validation_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "report/figures/figure_source.h"

namespace grainfield::pipelines {

namespace {

using report::Figure;
using report::Kind;
using report::Series;
using tracking::ClassScore;
using tracking::DetectionScores;

Figure figure_of(std::string name, std::string title, std::string note, Axis x, Axis y) {
    return report::empty_figure({"tracked"}, std::move(name), std::move(title), std::move(x),
                                std::move(y), std::move(note));
}

void add_series(Figure& figure, Kind kind, Series series) {
    series.kind = figure.kinds.size();
    figure.kinds.push_back(std::move(kind));
    if (!series.x.empty()) figure.series.push_back(std::move(series));
}

Figure phase_figure(const ValidationOutcome& outcome) {
    const DetectionScores& scores = outcome.scores.detection();
    Figure figure = figure_of(
        "pixel_locking", "Error against sub-pixel phase",
        "A tracker that is drawn to the pixel grid shows a wave.",
        {"phase", "Distance of the true centre from its pixel's", "px", Scale::linear, false},
        {"error", "Mean error", "px", Scale::linear, true});
    if (outcome.truth_is_whole) {
        figure.absent.push_back({0, "truths in whole pixels have no sub-pixel phase"});
        return figure;
    }
    for (const int axis : {0, 1}) {
        Series series;
        for (const auto& bin : scores.phase_curve(axis)) {
            if (!std::isfinite(bin.mean)) continue;
            series.x.push_back(bin.phase);
            series.y.push_back(bin.mean);
            series.error.push_back(bin.error);
        }
        add_series(figure, {axis == 0 ? "x" : "y", Mark::line, true}, std::move(series));
    }
    return figure;
}

Figure pull_figure(const DetectionScores& scores) {
    auto total = static_cast<double>(scores.pulls_beyond());
    for (const std::int64_t n : scores.pull_histogram()) total += static_cast<double>(n);
    const double beyond = static_cast<double>(scores.pulls_beyond()) / std::max(1.0, total);
    Figure figure = figure_of(
        "pulls", "Errors in units of the reported error",
        fmt::format(
            "Dashed: the normal distribution that right error bars would give. {:.2g} % lie "
            "beyond ±{:g}.",
            100 * beyond, DetectionScores::kLargestPull),
        {"pull", "(found − true)/reported", "", Scale::linear, false},
        {"density", "Probability density", "", Scale::linear, true});
    if (total == 0) {
        figure.absent.push_back({0, "no particle with a reported standard error was matched"});
        return figure;
    }
    constexpr double width = 2 * DetectionScores::kLargestPull / DetectionScores::kPullBins;
    Series bars, normal;
    for (std::size_t b = 0; b < scores.pull_histogram().size(); ++b) {
        const double centre =
            -DetectionScores::kLargestPull + (static_cast<double>(b) + 0.5) * width;
        bars.x.push_back(centre);
        bars.y.push_back(static_cast<double>(scores.pull_histogram()[b]) / total / width);
    }
    for (double t = -DetectionScores::kLargestPull; t <= DetectionScores::kLargestPull; t += 0.1) {
        normal.x.push_back(t);
        normal.y.push_back(std::exp(-t * t / 2) / std::sqrt(2 * std::numbers::pi));
    }
    add_series(figure, {"measured", Mark::steps, true}, std::move(bars));
    add_series(figure, {"normal", Mark::guide, true}, std::move(normal));
    return figure;
}

/// One value of each distance bin that has at least ten true particles.
template <class Value>
Series by_distance(const DetectionScores& scores, const Value& value) {
    Series series;
    for (std::size_t b = 0; b < kDistanceBins; ++b) {
        const ClassScore& s = scores.classes()[kTruthClasses + b];
        const double y = value(s);
        if (s.matched + s.missed < 10 || !std::isfinite(y)) continue;
        series.x.push_back(kLeastDistance + (static_cast<double>(b) + 0.5) * kDistanceStep);
        series.y.push_back(y);
    }
    return series;
}

const Axis& distance_axis() {
    static const Axis axis{"distance", "Distance of the nearest true particle", "a", Scale::linear,
                           false};
    return axis;
}

Figure missed_figure(const DetectionScores& scores) {
    Figure figure =
        figure_of("missed_by_distance", "Missed and false under overlap",
                  "Spheres of two layers overlap in projection: the nearer two centres, "
                  "the harder.",
                  distance_axis(), {"share", "Share", "", Scale::linear, true});
    add_series(figure, {"missed, 1 − recall", Mark::line, true},
               by_distance(scores, [](const ClassScore& s) { return 1 - s.recall(); }));
    add_series(figure, {"false, 1 − precision", Mark::line, true},
               by_distance(scores, [](const ClassScore& s) { return 1 - s.precision(); }));
    return figure;
}

Figure error_figure(const DetectionScores& scores) {
    Figure figure =
        figure_of("rmse_by_distance", "Error under overlap",
                  "Bound: joint Cramér–Rao bound of the particles that it resolves.",
                  distance_axis(), {"rmse", "RMS error per axis", "px", Scale::log, false});
    add_series(figure, {"all matched", Mark::line, true},
               by_distance(scores, [](const ClassScore& s) { return s.rmse_per_axis(); }));
    add_series(figure, {"resolved", Mark::line, true}, by_distance(scores, [](const ClassScore& s) {
                   return s.bound_ratio() * s.bound();
               }));
    add_series(figure, {"bound", Mark::line, true},
               by_distance(scores, [](const ClassScore& s) { return s.bound(); }));
    return figure;
}

struct Pair {
    std::vector<double> x, truth, tracked;
};

/// Values of one curve of both runs where their x agree; with phases only those of all particles.
Pair both(const ValidationOutcome& outcome, const char* name, const char* x, const char* y) {
    const auto curve_of = [&](std::size_t run) -> const Curve* {
        const ObservableResult* observable = outcome.runs[run].find(name);
        return observable == nullptr ? nullptr : observable->find_curve(name);
    };
    Pair pair;
    if (outcome.runs.size() < 2) return pair;
    const Curve* a = curve_of(0);
    const Curve* b = curve_of(1);
    if (a == nullptr || b == nullptr) return pair;
    const auto is_all = [](const Curve& curve, std::size_t row) {
        const auto phase = curve.text_columns.find("phase");
        return phase == curve.text_columns.end() || phase->second.at(row) == "all";
    };
    const auto &ax = a->find(x)->values, &bx = b->find(x)->values;
    for (std::size_t i = 0; i < ax.size(); ++i) {
        if (!is_all(*a, i)) continue;
        for (std::size_t j = 0; j < bx.size(); ++j) {
            if (!is_all(*b, j) || std::abs(bx[j] - ax[i]) > 1e-9 * std::abs(ax[i])) continue;
            pair.x.push_back(ax[i]);
            pair.truth.push_back(a->find(y)->values[i]);
            pair.tracked.push_back(b->find(y)->values[j]);
            break;
        }
    }
    return pair;
}

Figure offset_figure(const ValidationOutcome& outcome) {
    Figure figure =
        figure_of("msd_offset", "MSD: tracked less true",
                  "Errors that are independent from frame to frame raise the MSD by 4σ² at every "
                  "lag. Both are of the same frames: a paired difference, without an error.",
                  {"t", "Lag time t", "time unit", Scale::log, false},
                  {"offset", "Offset", "a²", Scale::linear, true});
    if (!outcome.runs.empty()) {
        figure.x.units = {run_unit(figure.x.unit, outcome.runs[0].source.time_unit)};
    }
    const Pair pair = both(outcome, "msd", "t", "msd");
    if (pair.x.empty()) {
        figure.absent.push_back({0, "no displacement was measured in both runs"});
        return figure;
    }
    Series offset{0, 0, pair.x, {}, {}};
    for (std::size_t i = 0; i < pair.x.size(); ++i) {
        offset.y.push_back(pair.tracked[i] - pair.truth[i]);
    }
    Series expected{0, 0, {pair.x.front(), pair.x.back()}, {}, {}};
    expected.y.assign(2, outcome.predicted_msd_offset);
    add_series(figure, {"tracked − true", Mark::line, true}, std::move(offset));
    add_series(figure, {"4σ², σ = RMSE", Mark::guide, true}, std::move(expected));
    return figure;
}

Figure ratio_figure(const ValidationOutcome& outcome) {
    Figure figure =
        figure_of("sk_ratio", "S(k): tracked over true",
                  "A share p found, missed by chance, makes S into p S + 1 − p and the "
                  "ratio p + (1 − p)/S; position errors damp S − 1 at large k. Both are "
                  "of the same frames: a paired ratio, without an error.",
                  {"k", "Wavevector k", "1/a", Scale::log, true},
                  {"ratio", "S tracked / S true", "", Scale::linear, false});
    const Pair pair = both(outcome, "sk", "k", "s");
    Series ratio{0, 0, {}, {}, {}};
    for (std::size_t i = 0; i < pair.x.size(); ++i) {
        const double r = pair.tracked[i] / pair.truth[i];
        if (!std::isfinite(r)) continue;
        ratio.x.push_back(pair.x[i]);
        ratio.y.push_back(r);
    }
    if (ratio.x.empty()) {
        figure.absent.push_back({0, "no structure factor was measured in both runs"});
        return figure;
    }
    if (outcome.scores.detection().frames() == 1) {
        figure.note +=
            " One frame: walls and mean density are in both, so that small k tell nothing.";
    }
    add_series(figure, {"ratio", Mark::line, true}, std::move(ratio));
    return figure;
}

}  // namespace

std::vector<Figure> validation_figures(const ValidationOutcome& outcome) {
    const DetectionScores& detection = outcome.scores.detection();
    return {phase_figure(outcome),   pull_figure(detection), missed_figure(detection),
            error_figure(detection), offset_figure(outcome), ratio_figure(outcome)};
}

}  // namespace grainfield::pipelines
