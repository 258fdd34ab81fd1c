#include "analysis/field_analysis.h"

#include "analysis/field_statistics.h"
#include "core/interrupt.h"

namespace grainfield::analysis {

std::vector<ObservableResult> analyze_fields(FieldSource& source,
                                             const StructureFactorOptions& options,
                                             Progress& progress) {
    FieldStatistics statistics(options, source.count());
    for (std::int64_t i = 0; i < source.count(); ++i) {
        throw_if_interrupted("analysis");
        statistics.write(source.read(i));
        progress.advance();
    }
    return statistics.results();
}

}  // namespace grainfield::analysis
