#pragma once

#include <string>
#include <vector>

#include "pipelines/tune/tune_settings.h"
#include "pipelines/tune/tuning.h"
#include "report/report.h"

namespace grainfield::pipelines {

/// Tables and figures of the page. `in_words`: how to track with the settings; empty: not said.
report::ReportAdditions tuning_report(const Tuning& tuning, const std::vector<Setting>& settings,
                                      const std::string& in_words);

}  // namespace grainfield::pipelines
