#include "app/bias_summary.h"

namespace grainfield::app {

nlohmann::ordered_json bias_facts(const tracking::BiasDecision& decision) {
    nlohmann::ordered_json facts{{"source", name_of(decision.source)},
                                 {"moved_a", nullptr},
                                 {"rms_before_a", nullptr},
                                 {"rms_after_a", nullptr},
                                 {"reason", nullptr}};
    if (decision.moved) facts["moved_a"] = *decision.moved;
    if (decision.source == tracking::BiasSource::none) {
        facts["reason"] = decision.reason;
        return facts;
    }
    facts["rms_before_a"] = decision.before;
    facts["rms_after_a"] = decision.after;
    return facts;
}

}  // namespace grainfield::app
