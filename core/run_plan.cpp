#include "core/run_plan.h"

#include <algorithm>

#include <fmt/format.h>

namespace grainfield {

std::string RunPlan::worded(std::string text) const {
    return wording_ ? wording_(std::move(text)) : text;
}

void RunPlan::run(std::string stage, std::string reason) {
    stages_.push_back({std::move(stage), true, worded(std::move(reason)), {}});
}

void RunPlan::skip(std::string stage, std::string reason, std::string saved) {
    stages_.push_back({std::move(stage), false, worded(std::move(reason)), std::move(saved)});
}

void RunPlan::warn(Warning warning) {
    warning.text = worded(std::move(warning.text));
    if (std::ranges::find(warnings_, warning.text, &Warning::text) == warnings_.end()) {
        warnings_.push_back(std::move(warning));
    }
}

void RunPlan::take(const RunPlan& other) {
    for (const PlannedStage& stage : other.stages()) {
        stages_.push_back({stage.stage, stage.runs, worded(stage.reason), stage.saved});
    }
    for (const Warning& warning : other.warnings()) warn(warning);
}

std::vector<PlannedStage> RunPlan::skipped() const {
    std::vector<PlannedStage> left_out;
    std::ranges::copy_if(stages_, std::back_inserter(left_out),
                         [](const PlannedStage& stage) { return !stage.runs; });
    return left_out;
}

std::string RunPlan::text() const {
    std::string text;
    for (const PlannedStage& stage : stages_) {
        text += fmt::format("{} {}", stage.runs ? "run " : "skip", stage.stage);
        if (!stage.reason.empty()) text += ": " + stage.reason;
        if (!stage.saved.empty()) text += " (saves " + stage.saved + ")";
        text += '\n';
    }
    return text;
}

}  // namespace grainfield
