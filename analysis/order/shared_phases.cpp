#include "analysis/order/shared_phases.h"

#include <cmath>

#include "analysis/order/shared_bond_order.h"

namespace grainfield::analysis {

std::vector<Observable> SharedPhases::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedSquareOrder>()};
}

SharedPhases::Sample SharedPhases::measure(const Moment& moment) const {
    const Pattern& pattern = moment.pattern();
    const BondOrderField& field = *moment.sample_of<SharedSquareOrder>();
    Sample sample{pattern.frame, pattern.time, pattern.id, {}};
    sample.abs_q.reserve(field.q.size());
    for (const auto& q : field.q) {
        sample.abs_q.push_back(static_cast<float>(std::sqrt(std::norm(q))));
    }
    return sample;
}

// A copy: others may read the sample after this.
void SharedPhases::add(Sample& sample, const Moment& /*moment*/) {
    history_.add(sample);
}

}  // namespace grainfield::analysis
