#include "analysis/density/field_analysis.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/density/field_statistics.h"
#include "core/support/interrupt.h"

namespace grainfield::analysis {
namespace {

constexpr const char* one_dimension =
    "fields of one dimension: the windows of this observable are squares";

}  // namespace

std::vector<ObservableResult> analyze_fields(FieldSource& source,
                                             const FieldAnalysisOptions& options,
                                             Progress& progress) {
    FieldStatistics statistics(options.sk, source.count());
    int dimension = 2;
    for (std::int64_t i = 0; i < source.count(); ++i) {
        throw_if_interrupted("analysis");
        const FieldFrame frame = source.read(i);
        dimension = frame.dimension;
        statistics.write(frame);
        progress.advance();
    }
    std::vector<ObservableResult> results = statistics.results();
    if (statistics.density() == nullptr) return results;
    ObservableResult fit = fit_result(*statistics.density(), options.fit);
    SyntheticInput input = synthetic_input(*statistics.density(), fit);
    input.is_field = true;
    if (dimension == 1) input.reason = one_dimension;
    results.push_back(std::move(fit));
    results.push_back(synthetic_result(input, options.synthetic));
    return results;
}

void add_fits(std::vector<ObservableResult>& results, const FieldFrame* like,
              const FieldAnalysisOptions& options) {
    const auto sk = std::ranges::find(results, "sk", &ObservableResult::name);
    if (sk == results.end()) return;
    SyntheticInput input;
    input.spectrum = recorded_spectrum(*sk);
    input.fit = fit_result(input.spectrum, options.fit);
    input.is_field = true;
    input.density = 1;  // of volume: S is that of the content of windows
    if (like == nullptr) {
        input.reason = "the file stores no field: the side of the box is not known";
    } else {
        input.side = std::sqrt(like->density.front().box().area());
        if (like->dimension == 1) input.reason = one_dimension;
    }
    results.push_back(input.fit);
    results.push_back(synthetic_result(input, options.synthetic));
}

}  // namespace grainfield::analysis
