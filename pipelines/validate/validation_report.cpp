#include "pipelines/validate/validation_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/order/bond_order_options.h"
#include "pipelines/job.h"
#include "pipelines/validate/threshold_table.h"
#include "pipelines/validate/validation_figures.h"
#include "report/text.h"
#include "tracking/score/match_positions.h"

namespace grainfield::pipelines {

namespace {

using report::Table;
using tracking::ClassScore;
using tracking::DetectionScores;

report::TableCell number(double value, const char* format = "{:.4g}") {
    if (!std::isfinite(value)) return {};
    return {value, fmt::format(fmt::runtime(format), value), false};
}

report::TableCell share(double value) {
    return number(value, "{:.5f}");
}

/// With its sign, and the minus of typographers.
report::TableCell bias(double value) {
    report::TableCell cell = number(value, "{:+.4f}");
    if (cell.text.starts_with('-')) cell.text.replace(0, 1, "−");
    return cell;
}

report::TableCell count(std::int64_t value) {
    return {static_cast<double>(value), fmt::format("{}", value), false};
}

/// "Title of a row" as a part of a sentence.
std::string listed(const std::vector<std::string>& titles) {
    std::string text;
    for (const std::string& title : titles) text += (text.empty() ? "" : ", ") + title;
    return text;
}

bool is_one_frame(const ValidationOutcome& outcome) {
    return outcome.scores.detection().frames() == 1;
}

Table class_table(const ValidationOutcome& outcome) {
    const DetectionScores& scores = outcome.scores.detection();
    Table table;
    table.name = "scores";
    table.title = "Positions, by class of true particle";
    table.note = fmt::format(
        "{}. Matched one-to-one within {:.2f} px (D/4). all: at least D inside the frame; "
        "border: nearer, where at least D/4 inside. Crystal: |Q4| ≥ {}. Ratio: RMSE over the "
        "joint "
        "Cramér–Rao bound, both over particles whose bound is below a third of the gate "
        "(resolved). "
        "Pull: error over the reported standard error, RMS; within 2σ should be 0.954.",
        counted(scores.frames(), "frame"), scores.gate(), analysis::solid_order);
    if (std::string caveat = bound_caveat(outcome); !caveat.empty()) {
        caveat.front() = 'T';
        table.note += " " + caveat + ".";
    }
    table.columns = {{"particles", "True", ""},          {"missed", "Missed", ""},
                     {"spurious", "False", ""},          {"recall", "Recall", ""},
                     {"precision", "Precision", ""},     {"jaccard", "Jaccard", ""},
                     {"bias_x", "Bias x", "px"},         {"bias_y", "Bias y", "px"},
                     {"rmse_x", "RMSE x", "px"},         {"rmse_y", "RMSE y", "px"},
                     {"resolved", "Resolved", ""},       {"bound", "Bound", "px"},
                     {"bound_ratio", "Ratio", ""},       {"pull_rms", "Pull", ""},
                     {"within_2_sigma", "Within 2σ", ""}};
    for (std::size_t c = 0; c < kTruthClasses; ++c) {
        const ClassScore& s = scores.classes()[c];
        const std::int64_t particles = s.matched + s.missed;
        table.rows.push_back(
            {s.name,
             {count(particles), count(s.missed), count(s.spurious), share(s.recall()),
              share(s.precision()), share(s.jaccard()), bias(s.bias().x), bias(s.bias().y),
              number(s.rmse().x, "{:.4f}"), number(s.rmse().y, "{:.4f}"),
              number(static_cast<double>(s.resolved) / static_cast<double>(s.matched)),
              number(s.bound(), "{:.4f}"), number(s.bound_ratio(), "{:.2f}"),
              number(s.pull_rms(), "{:.2f}"), number(s.within_two_sigma(), "{:.3f}")}});
    }
    return table;
}

std::string locking_in_words(const ValidationOutcome& outcome,
                             const DetectionScores::Locking& locking) {
    if (outcome.truth_is_whole) return "truths in whole pixels have no sub-pixel phase";
    if (!std::isfinite(locking.error) || !std::isfinite(locking.rms)) {
        return "too few particles for every phase";
    }
    return fmt::format("chance: {:.5f}; RMS of the whole curve {:.5f}", locking.error, locking.rms);
}

Table track_table(const ValidationOutcome& outcome) {
    const auto& t = outcome.tracks;
    const auto& layers = outcome.scores.layers();
    Table table;
    table.name = "track_scores";
    const bool has_tracks = !is_one_frame(outcome);
    table.title = has_tracks ? "Tracks, pixels, layers" : "Pixels, layers";
    table.note = has_tracks ? "Over the particles of class all. α, β, JSC and JSCθ as in the ISBI "
                              "challenge, ε = D/4."
                            : "Over the particles of class all. Not possible with one frame: α, β, "
                              "JSC, JSCθ, links, switches, fragments.";
    table.note += " Pixel locking: first harmonic of the mean error against the sub-pixel phase.";
    table.columns = {{"value", "Value", "", false}, {"meaning", "Meaning", "", true}};
    const auto row = [&](const char* name, report::TableCell value, std::string meaning) {
        table.rows.push_back({name, {std::move(value), {std::nan(""), std::move(meaning), false}}});
    };
    if (has_tracks) {
        row("α", share(t.alpha), "1: all true tracks followed");
        row("β", share(t.beta), "α less what spurious tracks cost");
        row("JSC", share(t.jaccard_points), "Jaccard of positions in paired tracks");
        row("JSCθ", share(t.jaccard_tracks), "Jaccard of tracks");
        row("correct links", share(t.correct_link_fraction()),
            fmt::format("of {} times a true particle was found again", t.links));
        row("switches", count(t.switches), "found again under another identity");
        row("fragments", count(t.fragments), "found again after frames in which it was missed");
        row("wrong links", count(t.wrong_links), "steps from one true particle to another");
    }
    for (const int axis : {0, 1}) {
        const auto locking = outcome.scores.detection().pixel_locking(axis);
        row(axis == 0 ? "pixel locking x [px]" : "pixel locking y [px]",
            number(locking.amplitude, "{:.5f}"), locking_in_words(outcome, locking));
    }
    const bool has_order = std::isfinite(outcome.scores.q4_bias());
    row("|Q₄| error", number(outcome.scores.q4_rms(), "{:.4f}"),
        has_order ? fmt::format("RMS over {} particles; mean {:+.5f}", outcome.scores.q4_samples(),
                                outcome.scores.q4_bias())
                  : std::string("no particle has both"));
    const bool labelled = layers.labelled > 0;
    row("layer labels", labelled ? share(layers.accuracy()) : report::TableCell{},
        labelled ? fmt::format("right of {}", layers.labelled)
                 : std::string("the tracker gave no layers"));
    row("layer labels, up to a flip",
        layers.tested > 0 ? share(layers.accuracy_up_to_flip()) : report::TableCell{},
        fmt::format("of {}: sides exchanged where that is better for a cluster of overlapping "
                    "spheres, one label of each cluster not counted",
                    layers.tested));
    return table;
}

/// What one frame does not give: values that are not there, and S(k) at small k, where a single
/// frame shows its walls.
bool needs_more_frames(const DownstreamEffect& effect) {
    const bool is_missing = !std::isfinite(effect.truth) && !std::isfinite(effect.tracked);
    return is_missing || effect.name == "s_lowest_k" || effect.name == "s_low_k";
}

Table effect_table(const ValidationOutcome& outcome) {
    Table table;
    table.name = "downstream";
    table.title = "What the errors do to the results";
    table.note =
        "The same analysis of the true and of the tracked positions of the same frames. σ: the "
        "statistical error of the tracked value.";
    table.columns = {{"true", "True", ""},
                     {"tracked", "Tracked", ""},
                     {"difference", "Difference", ""},
                     {"sigma", "σ", ""},
                     {"remark", "Remark", "", true}};
    std::vector<std::string> not_of_one;
    for (const DownstreamEffect& e : outcome.effects) {
        if (is_one_frame(outcome) && needs_more_frames(e)) {
            not_of_one.push_back(e.title);
            continue;
        }
        const std::string unit = typeset_text(e.unit, outcome.runs[0].source.time_unit);
        table.rows.push_back({unit.empty() ? e.title : e.title + " [" + unit + "]",
                              {number(e.truth),
                               number(e.tracked),
                               number(e.tracked - e.truth, "{:+.2g}"),
                               number(e.error, "{:.2g}"),
                               {std::nan(""), e.reason, false}}});
    }
    if (is_one_frame(outcome)) {
        not_of_one.emplace_back("mean squared displacement");
        table.note += " Not possible with one frame: " + listed(not_of_one) + ".";
        return table;
    }
    table.rows.push_back({"MSD at the shortest lag: offset, where 4σ² is expected [a²]",
                          {number(outcome.predicted_msd_offset, "{:.3g}"),
                           number(outcome.msd_offset, "{:.3g}"),
                           number(outcome.msd_offset - outcome.predicted_msd_offset, "{:+.2g}"),
                           {},
                           {}}});
    return table;
}

std::string verdict(const ClassScore& all, bool truth_is_whole,
                    const std::vector<ThresholdCheck>& checks) {
    const auto text_of = [](std::int64_t n) { return report::count_text(static_cast<double>(n)); };
    const std::int64_t spheres = all.matched + all.missed;
    std::string text =
        fmt::format("{} of {} true sphere{} missed, {} false", text_of(all.missed),
                    text_of(spheres), spheres == 1 ? "" : "s", text_of(all.spurious));
    if (const double error = all.rmse_per_axis(); std::isfinite(error)) {
        text += fmt::format("; error {:.3f} px per axis", error);
        if (truth_is_whole) {
            text += fmt::format(", of which whole-pixel truths may make {} px", kRoundingError);
        }
    }
    if (checks.empty()) return text;
    const auto missed = std::ranges::count_if(checks, [](const auto& c) { return !c.met(); });
    return text + (missed == 0
                       ? std::string("; all thresholds met")
                       : fmt::format("; {} of {} thresholds not met", missed, checks.size()));
}

/// In the frames that the page shows.
std::vector<report::MarkedSphere> missed_and_false(const ValidationOutcome& outcome) {
    std::vector<report::MarkedSphere> marked;
    if (outcome.runs.size() < 2) return marked;
    const auto& seen = outcome.runs[0].previews;
    const auto& found = outcome.runs[1].previews;
    for (std::size_t p = 0; p < std::min(seen.size(), found.size()); ++p) {
        const Snapshot& truth = seen[p].snapshot;
        const Snapshot& tracked = found[p].snapshot;
        const std::vector<int> partner = tracking::match_positions(
            tracked.position, truth.position, outcome.scores.detection().gate());
        std::vector<bool> is_true(tracked.size(), false);
        for (std::size_t i = 0; i < truth.size(); ++i) {
            if (partner[i] < 0) {
                marked.push_back({1, tracked.frame, truth.position[i], "missed"});
            } else {
                is_true[static_cast<std::size_t>(partner[i])] = true;
            }
        }
        for (std::size_t i = 0; i < tracked.size(); ++i) {
            if (!is_true[i]) marked.push_back({1, tracked.frame, tracked.position[i], "false"});
        }
    }
    return marked;
}

}  // namespace

report::ReportAdditions validation_report(const ValidationOutcome& outcome,
                                          const std::vector<ThresholdCheck>& checks) {
    const DetectionScores& detection = outcome.scores.detection();
    report::ReportAdditions additions;
    if (!checks.empty()) additions.tables.push_back(threshold_table(checks));
    additions.tables.push_back(class_table(outcome));
    additions.tables.push_back(track_table(outcome));
    if (outcome.runs.size() > 1 && !outcome.effects.empty()) {
        additions.tables.push_back(effect_table(outcome));
    }
    additions.figures = validation_figures(outcome);
    additions.verdict = verdict(detection.classes().front(), outcome.truth_is_whole, checks);
    additions.marked = missed_and_false(outcome);
    additions.marked_as = "Missed and false";
    return additions;
}

}  // namespace grainfield::pipelines
