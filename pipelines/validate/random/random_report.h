#pragma once

#include <vector>

#include "core/results.h"
#include "pipelines/validate/random/random_scores.h"
#include "report/report.h"

namespace grainfield::pipelines {

/// Medians and worst, the table of the scenes, and time against error.
report::ReportAdditions random_report(const std::vector<SceneScore>& scenes,
                                      const std::vector<ThresholdCheck>& checks);

/// What the page shows of the worst scenes: the frame with what was missed, with what is false, and
/// with all that was found; a run each.
std::vector<Results> random_runs(const std::vector<SceneScore>& scenes,
                                 const std::vector<SeenScene>& worst);

}  // namespace grainfield::pipelines
