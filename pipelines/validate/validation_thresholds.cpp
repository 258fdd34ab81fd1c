#include "pipelines/validate/validation_thresholds.h"

#include <cmath>

#include <fmt/format.h>

#include "pipelines/validate/validation_outcome.h"

namespace grainfield::pipelines {

OptionTable describe(ValidationThresholds& t) {
    OptionTable table("threshold");
    table.number("recall", t.recall, "-", {0, 1}, "least recall of all; auto: not checked");
    table.number("recall-crystal", t.recall_crystal, "-", {0, 1}, "least recall in the crystal");
    table.number("precision", t.precision, "-", {0, 1}, "least precision");
    table.number("rmse", t.rmse, "px", {0, 1e6}, "largest RMS error per axis");
    table.number("rmse-crystal", t.rmse_crystal, "px", {0, 1e6},
                 "largest RMS error per axis in the crystal");
    table.number("bound-ratio", t.bound_ratio, "-", {0, 1e9},
                 "largest RMS error over the Cramér–Rao bound");
    table.number("correct-links", t.correct_links, "-", {0, 1}, "least share of correct links");
    table.number("layers-named", t.layers_named, "-", {0, 1},
                 "least share of spheres whose layer is named");
    table.number("layers-up-to-flip", t.layers_up_to_flip, "-", {0, 1},
                 "least share of right layers, each cluster the right way up");
    table.number("alpha", t.alpha, "-", {-1e9, 1}, "least α of the tracks");
    table.number("q4-error", t.q4_error, "-", {0, 1}, "largest RMS error of |Q4|");
    return table;
}

std::string ThresholdCheck::text() const {
    const std::string measured =
        std::isnan(value) ? "not measured"
                          : fmt::format("{:.5g}{}", value, unit == "-" ? "" : " " + unit);
    return fmt::format("{} {}, {} {:g} asked for", name, measured,
                       is_least ? "at least" : "at most", limit);
}

std::vector<ThresholdCheck> check(const ValidationThresholds& t, const ValidationOutcome& outcome) {
    const auto& all = outcome.scores.detection().find("all");
    const auto& crystal = outcome.scores.detection().find("crystal");
    std::vector<ThresholdCheck> checks;
    const auto add = [&](const char* name, const char* unit, const std::optional<double>& limit,
                         double value, bool is_least) {
        if (limit) checks.push_back({name, unit, *limit, value, is_least});
    };
    add("recall", "-", t.recall, all.recall(), true);
    add("recall-crystal", "-", t.recall_crystal, crystal.recall(), true);
    add("precision", "-", t.precision, all.precision(), true);
    add("rmse", "px", t.rmse, all.rmse_per_axis(), false);
    add("rmse-crystal", "px", t.rmse_crystal, crystal.rmse_per_axis(), false);
    add("bound-ratio", "-", t.bound_ratio, all.bound_ratio(), false);
    add("correct-links", "-", t.correct_links, outcome.tracks.correct_link_fraction(), true);
    add("layers-named", "-", t.layers_named, outcome.scores.layers().named(), true);
    add("layers-up-to-flip", "-", t.layers_up_to_flip,
        outcome.scores.layers().accuracy_up_to_flip(), true);
    add("alpha", "-", t.alpha, outcome.tracks.alpha, true);
    add("q4-error", "-", t.q4_error, outcome.scores.q4_rms(), false);
    return checks;
}

}  // namespace grainfield::pipelines
