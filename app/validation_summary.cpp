#include "app/validation_summary.h"

#include <cmath>

#include <fmt/format.h>

#include "app/session.h"
#include "report/text.h"

namespace grainfield::app {

using pipelines::DownstreamEffect;
using pipelines::kTruthClasses;
using pipelines::ThresholdCheck;
using pipelines::ValidationOutcome;
using report::number_text;

namespace {

using nlohmann::ordered_json;
using tracking::ClassScore;

/// NaN has no place in JSON.
ordered_json number(double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json facts(const ClassScore& s) {
    ordered_json facts;
    facts["recall"] = number(s.recall());
    facts["precision"] = number(s.precision());
    facts["jaccard"] = number(s.jaccard());
    facts["rmse_px"] = number(s.rmse_per_axis());
    facts["bias_px"] = {number(s.bias().x), number(s.bias().y)};
    facts["bound_px"] = number(s.bound());
    facts["bound_ratio"] = number(s.bound_ratio());
    facts["pull_rms"] = number(s.pull_rms());
    facts["within_2_sigma"] = number(s.within_two_sigma());
    facts["matched"] = s.matched;
    facts["missed"] = s.missed;
    facts["spurious"] = s.spurious;
    return facts;
}

/// Nothing where the tracker named no layers.
std::string layer_text(const tracking::LayerScore& layers) {
    if (layers.labelled == 0) return {};
    std::string text =
        fmt::format("  layers    {:.1f} % of the spheres found are named", 100 * layers.named());
    if (layers.tested > 0) {
        text +=
            fmt::format("; {:.2f} % of the labels are right, up to one exchange in each cluster",
                        100 * layers.accuracy_up_to_flip());
    }
    return text + "\n";
}

}  // namespace

ordered_json summary_facts(const ValidationOutcome& outcome, const tracking::TrackSummary& tracked,
                           const std::vector<ThresholdCheck>& checks) {
    const auto& detection = outcome.scores.detection();
    ordered_json all = facts(detection.find("all"));
    ordered_json facts_of_run;
    facts_of_run["frames"] = detection.frames();
    for (const char* key : {"recall", "precision", "rmse_px", "bound_ratio"}) {
        facts_of_run[key] = all[key];
    }
    for (std::size_t c = 0; c < kTruthClasses; ++c) {
        facts_of_run["classes"][detection.classes()[c].name] = facts(detection.classes()[c]);
    }
    const auto& t = outcome.tracks;
    facts_of_run["tracks"] = {{"alpha", number(t.alpha)},
                              {"beta", number(t.beta)},
                              {"jsc", number(t.jaccard_points)},
                              {"jsc_theta", number(t.jaccard_tracks)},
                              {"correct_links", number(t.correct_link_fraction())},
                              {"links", t.links},
                              {"switches", t.switches},
                              {"fragments", t.fragments},
                              {"wrong_links", t.wrong_links}};
    const auto locking = [&](int axis) { return number(detection.pixel_locking(axis).amplitude); };
    facts_of_run["pixel_locking_px"] = {locking(0), locking(1)};
    facts_of_run["layers_named"] = number(outcome.scores.layers().named());
    facts_of_run["layer_accuracy"] = number(outcome.scores.layers().accuracy());
    facts_of_run["layer_accuracy_up_to_flip"] =
        number(outcome.scores.layers().accuracy_up_to_flip());
    facts_of_run["q4_error"] = number(outcome.scores.q4_rms());
    facts_of_run["msd_offset"] = number(outcome.msd_offset);
    facts_of_run["msd_offset_expected"] = number(outcome.predicted_msd_offset);
    facts_of_run["downstream"] = ordered_json::object();
    for (const DownstreamEffect& e : outcome.effects) {
        auto& effect = facts_of_run["downstream"][e.name];
        effect = {{"true", number(e.truth)}, {"tracked", number(e.tracked)}};
        if (!e.reason.empty()) effect["reason"] = e.reason;
    }
    facts_of_run["thresholds"] = ordered_json::array();
    for (const ThresholdCheck& c : checks) {
        facts_of_run["thresholds"].push_back(
            {{"name", c.name}, {"limit", c.limit}, {"value", number(c.value)}, {"met", c.met()}});
    }
    const auto& ms = tracked.ms_per_frame;
    facts_of_run["ms_per_frame"] = {{"render", ms.read},
                                    {"detect", ms.detect},
                                    {"refine", ms.refine},
                                    {"link", ms.link},
                                    {"score", ms.write}};
    return facts_of_run;
}

std::string summary_text(const std::string& output, const ValidationOutcome& outcome,
                         const std::vector<ThresholdCheck>& checks) {
    const auto& detection = outcome.scores.detection();
    const std::string caveat = pipelines::bound_caveat(outcome);
    std::string text = fmt::format("{}: {}\n  {:<10}{:>10}{:>9}{:>11}{:>10}{:>7}{:>7}", output,
                                   counted(detection.frames(), "frame"), "", "true", "recall",
                                   "precision", "RMSE/px", "pull", "in 2σ");
    text += caveat.empty() ? fmt::format("{:>8}\n", "/bound") : "\n";
    for (std::size_t c = 0; c < kTruthClasses; ++c) {
        const ClassScore& s = detection.classes()[c];
        if (s.matched + s.missed == 0) continue;
        text += fmt::format(
            "  {:<10}{:>10}{:>9}{:>11}{:>10}{:>7}{:>7}", s.name, s.matched + s.missed,
            number_text(s.recall(), "{:.5f}"), number_text(s.precision(), "{:.5f}"),
            number_text(s.rmse_per_axis(), "{:.4f}"), number_text(s.pull_rms(), "{:.2f}"),
            number_text(s.within_two_sigma(), "{:.3f}"));
        text +=
            caveat.empty() ? fmt::format("{:>8}\n", number_text(s.bound_ratio(), "{:.2f}")) : "\n";
    }
    if (!caveat.empty()) text += fmt::format("  {:<10}{}\n", "bound", caveat);
    if (detection.frames() > 1) {
        const auto& t = outcome.tracks;
        text += fmt::format("  tracks    α {}, β {}, JSC {}, JSCθ {}, links {}\n",
                            number_text(t.alpha, "{:.4f}"), number_text(t.beta, "{:.4f}"),
                            number_text(t.jaccard_points, "{:.4f}"),
                            number_text(t.jaccard_tracks, "{:.4f}"),
                            number_text(t.correct_link_fraction(), "{:.5f}"));
    }
    text += layer_text(outcome.scores.layers());
    for (const ThresholdCheck& c : checks) {
        text += fmt::format("  {:<10}{}\n", c.met() ? "met" : "MISSED", c.text());
    }
    return text;
}

std::string missed_thresholds(const std::vector<ThresholdCheck>& checks) {
    std::string text;
    for (const ThresholdCheck& c : checks) {
        if (!c.met()) text += (text.empty() ? "thresholds missed: " : "; ") + c.text();
    }
    return text.empty() ? text : text + ".";
}

}  // namespace grainfield::app
