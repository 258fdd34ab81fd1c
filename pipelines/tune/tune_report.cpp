#include "pipelines/tune/tune_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/fit_quality.h"
#include "pipelines/job.h"
#include "report/figures/figure_source.h"
#include "report/page/cards.h"
#include "report/text.h"

namespace grainfield::pipelines {

namespace {

using report::Figure;
using report::Series;
using report::Table;
using tracking::Polarity;
using tracking::Survey;

std::vector<double> distances(const Tuning& tuning) {
    return tuning.gathered([&](const Survey& survey) {
        std::vector<double> values =
            tracking::nearest_distances(survey.found.position, 2.5 * tuning.diameter());
        for (double& d : values) d /= tuning.diameter();
        return values;
    });
}

std::vector<double> evidence(const Tuning& tuning) {
    return tuning.gathered([](const Survey& survey) { return survey.evidence; });
}

struct Histogram {
    std::vector<double> x, y;
    double total = 0;
};

/// Share of the values in each bin; values outside count for the total only.
Histogram histogram(const std::vector<double>& values, double low, double high, int bins) {
    Histogram h;
    h.y.assign(static_cast<std::size_t>(bins), 0.0);
    const double width = (high - low) / bins;
    for (int i = 0; i < bins; ++i) h.x.push_back(low + (i + 0.5) * width);
    for (const double v : values) {
        h.total += 1;
        if (!(v >= low && v < high)) continue;
        h.y[std::min(static_cast<std::size_t>((v - low) / width), h.y.size() - 1)] += 1;
    }
    for (double& y : h.y) y /= std::max(h.total, 1.0);
    return h;
}

Figure figure_of(std::string name, std::string title, std::string note, Axis x, Axis y) {
    return report::empty_figure({"frames"}, std::move(name), std::move(title), std::move(x),
                                std::move(y), std::move(note));
}

void add(Figure& figure, report::Kind kind, Series series) {
    series.kind = figure.kinds.size();
    figure.kinds.push_back(std::move(kind));
    figure.series.push_back(std::move(series));
}

/// A line from the bottom to the top of what is drawn.
void add_mark(Figure& figure, std::string label, double x) {
    double top = 0;
    for (const Series& series : figure.series) {
        for (const double y : series.y) top = std::max(top, y);
    }
    add(figure, {std::move(label), Mark::guide, true}, {0, 0, {x, x}, {0, top}, {}});
}

Figure phase_figure(const Tuning& tuning) {
    Figure figure = figure_of(
        "subpixel_phase", "Where positions fall between the pixels",
        "One is even. A peak at 0 or ±0.5 is a bias towards the pixel grid: blurred or saturated "
        "edges, a wrong D or w. Lattices and spheres that rest are uneven of themselves.",
        {"phase", "Distance of the position from its pixel's centre", "px", Scale::linear, false},
        {"density", "Density", "", Scale::linear, true});
    constexpr int bins = 20;
    for (const int axis : {0, 1}) {
        const Histogram h = histogram(tuning.gathered([axis](const Survey& survey) {
            std::vector<double> phases;
            for (const Vec2 p : survey.found.position) {
                const double v = axis == 0 ? p.x : p.y;
                phases.push_back(v - std::floor(v + 0.5));
            }
            return phases;
        }),
                                      -0.5, 0.5, bins);
        Series series{0, 0, h.x, {}, {}};
        for (const double share : h.y) {
            series.y.push_back(share * bins);
            series.error.push_back(bins * std::sqrt(share / std::max(h.total, 1.0)));
        }
        add(figure, {axis == 0 ? "x" : "y", Mark::line, true}, std::move(series));
    }
    add(figure, {"even", Mark::guide, true}, {0, 0, {-0.5, 0.5}, {1, 1}, {}});
    return figure;
}

/// How many spheres have which value, as shares.
Figure share_figure(const std::string& name, const std::string& title, const std::string& note,
                    Axis value, const Histogram& h) {
    Figure figure = figure_of(name, title, note, std::move(value),
                              {"share", "Share of the spheres", "", Scale::linear, true});
    add(figure, {"spheres", Mark::steps, true}, {0, 0, h.x, h.y, {}});
    return figure;
}

Figure distance_figure(const Tuning& tuning) {
    const bool is_true = tuning.options.sphere_diameter.has_value();
    Figure figure = share_figure(
        "nearest_neighbour", "Distance of the nearest neighbour",
        "What lies below the line that the height of the cell draws is false. Without a height a "
        "few pairs far below all others are suspect too.",
        {"distance", "Distance", is_true ? "a" : "D", Scale::linear, true},
        histogram(distances(tuning), 0, 2.5, 100));
    const double forbidden = tuning.forbidden_distance() / tuning.diameter();
    if (forbidden > 0) add_mark(figure, "no room between the plates below", forbidden);
    add_mark(figure, "taken for one sphere below (detect.separation)",
             tuning.options.detection.separation * tuning.model.disc.diameter / tuning.diameter());
    return figure;
}

Figure evidence_figure(const Tuning& tuning) {
    Figure figure = share_figure(
        "evidence", "What each sphere explains of the image",
        "One for spheres that stand alone; hidden ones explain less. The least follows from the "
        "fit of the model; detect.evidence sets it, in a gap between false and hidden spheres.",
        {"evidence", "Share of the misfit of an isolated sphere", "", Scale::linear, true},
        histogram(evidence(tuning), 0, 1.3, 65));
    double least = 0;
    for (const Survey& survey : tuning.surveys) least = std::max(least, survey.found.evidence);
    add_mark(figure, "least (detect.evidence)", least);
    return figure;
}

Figure residual_figure(const Tuning& tuning) {
    return share_figure(
        "residual", "Misfit about each sphere",
        "RMS of image − model within reach. A tail to the right: false or wrongly placed spheres, "
        "or an image model that does not hold (meeting edges, a mirror rim).",
        {"residual", "RMS residual", "contrast", Scale::linear, true},
        histogram(tuning.gathered([](const Survey& survey) { return survey.found.residual; }), 0,
                  0.25, 100));
}

Figure profile_figure(const Tuning& tuning) {
    Figure figure = figure_of(
        "radial_profile", "Darkness about spheres that stand alone",
        fmt::format("Mean over pixels that only one sphere reaches. A core or rim off the {} edge "
                    "is what the sphere reflects; it moves spheres that overlap unless it is "
                    "learned (calibrate.profile).",
                    tuning.model.disc.shape->name()),
        {"r", "Distance from the centre", "px", Scale::linear, true},
        {"darkness", "Darkness", "contrast", Scale::linear, false});
    constexpr double step = 0.25;
    const auto& disc = tuning.model.disc;
    const auto bins = static_cast<std::size_t>(disc.reach() / step) + 1;
    std::vector<double> sum(bins, 0.0);
    std::vector<double> count(bins, 0.0);
    for (const Survey& survey : tuning.surveys) {
        for (const tracking::RadialBin& bin : survey.profile) {
            const auto i = std::min(static_cast<std::size_t>(bin.r / step), bins - 1);
            sum[i] += bin.count * bin.darkness;
            count[i] += bin.count;
        }
    }
    Series measured{0, 0, {}, {}, {}};
    Series model{0, 0, {}, {}, {}};
    Series learned{0, 0, {}, {}, {}};
    for (std::size_t i = 0; i < bins; ++i) {
        const double r = (static_cast<double>(i) + 0.5) * step;
        model.x.push_back(r);
        model.y.push_back(disc.darkness(r));
        if (!tuning.model.correction.is_zero()) {
            learned.x.push_back(r);
            learned.y.push_back(disc.darkness(r) + static_cast<double>(tuning.model.correction(
                                                       static_cast<float>(r))));
        }
        if (count[i] < 5) continue;
        measured.x.push_back(r);
        measured.y.push_back(sum[i] / count[i]);
    }
    if (measured.x.empty()) {
        figure.absent.push_back({0, "no sphere stands alone"});
        return figure;
    }
    add(figure, {"measured", Mark::line, true}, std::move(measured));
    add(figure, {std::string(disc.shape->name()), Mark::curve, true}, std::move(model));
    if (!learned.x.empty()) add(figure, {"learned", Mark::curve, true}, std::move(learned));
    return figure;
}

Table calibration_table(const Tuning& tuning) {
    Table table;
    table.name = "calibration";
    table.title = "What was found";
    table.note = fmt::format("{} looked at, each from a cold start.",
                             counted(static_cast<std::int64_t>(tuning.surveys.size()), "frame"));
    table.columns = {{"value", "Value", "", true}};
    const auto row = [&](const char* name, std::string value, bool failed = false) {
        table.rows.push_back(
            {name, {{std::numeric_limits<double>::quiet_NaN(), std::move(value), failed}}});
    };
    const auto& model = tuning.model;
    row("Spheres a frame", report::count_text(std::round(tuning.particles_mean())));
    row("Polarity", model.polarity == Polarity::dark ? "dark" : "bright");
    row("Apparent diameter D", fmt::format("{:.3f} px", model.disc.diameter));
    row("Edge width w", fmt::format("{:.3f} px", model.disc.edge_width));
    row("Contrast",
        fmt::format("{:.1f} counts", std::abs(model.background(0, 0) - model.dark_level)));
    row("Light", model.background.is_uniform() ? "even" : "uneven: a smooth surface is fitted");
    row("Meeting edges", model.overlap->words());
    row("Profile", model.correction.is_zero()
                       ? std::string(model.disc.shape->name())
                       : fmt::format("learned, up to {:.3f} of the contrast off {}",
                                     model.correction.largest(), model.disc.shape->name()));
    std::int64_t unsettled = 0;
    for (const Survey& survey : tuning.surveys) {
        unsettled += survey.found.unsettled;
    }
    row("Noise", fmt::format("{:.4f} of the contrast", tuning.noise()));
    row("RMS residual", fmt::format("{:.4f} of the contrast", tuning.residual_rms()),
        fit_quality(tuning.residual_rms(), tuning.noise()) == FitQuality::poor);
    row("Standard error, median", fmt::format("{:.4f} px", tuning.median_error()));
    std::vector<Vec2> all;
    for (const Survey& survey : tuning.surveys) {
        all.insert(all.end(), survey.found.position.begin(), survey.found.position.end());
    }
    const tracking::PhaseBias bias = tracking::phase_bias(all);
    row("Bias to the pixel grid",
        fmt::format("{:.3f} in x, {:.3f} in y; chance gives {:.3f}", bias.x, bias.y, bias.chance),
        std::max(bias.x, bias.y) > 4 * bias.chance);
    if (const double least = tuning.forbidden_distance(); least > 0) {
        const std::vector<double> apart = distances(tuning);
        const auto impossible = std::count_if(
            apart.begin(), apart.end(), [&](double d) { return d < least / tuning.diameter(); });
        row("Spheres without room between the plates", fmt::format("{}", impossible),
            impossible > 0);
    }
    row("Still moving after the last sweep", fmt::format("{}", unsettled));
    return table;
}

std::string verdict(const Tuning& tuning) {
    const double spheres = std::round(tuning.particles_mean());
    return fmt::format(
        "{} sphere{} a frame; {} discs of {:.2f} px; {}", report::count_text(spheres),
        spheres == 1 ? "" : "s", tuning.model.polarity == Polarity::dark ? "dark" : "bright",
        tuning.model.disc.diameter, report::residual_words(tuning.residual_rms(), tuning.noise()));
}

}  // namespace

report::ReportAdditions tuning_report(const Tuning& tuning, const std::vector<Setting>& settings,
                                      const std::string& in_words) {
    std::vector<report::CopyBlock> blocks{{"Suggested settings", toml_of(settings), ""}};
    if (!in_words.empty()) blocks.push_back({"The same as a command", in_words, ""});
    return {.tables = {calibration_table(tuning)},
            .figures = {phase_figure(tuning), distance_figure(tuning), evidence_figure(tuning),
                        residual_figure(tuning), profile_figure(tuning)},
            .verdict = verdict(tuning),
            .blocks = std::move(blocks)};
}

}  // namespace grainfield::pipelines
