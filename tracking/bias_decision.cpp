#include "tracking/bias_decision.h"

#include <fmt/format.h>

namespace grainfield::tracking {

const char* name_of(BiasSource source) {
    switch (source) {
        case BiasSource::general:
            return "general";
        case BiasSource::film:
            return "film";
        case BiasSource::none:
            break;
    }
    return "none";
}

std::optional<BiasSource> bias_source_named(const std::string& name) {
    for (const BiasSource source : {BiasSource::none, BiasSource::general, BiasSource::film}) {
        if (name == name_of(source)) return source;
    }
    return std::nullopt;
}

std::string in_words(const BiasDecision& decision) {
    switch (decision.source) {
        case BiasSource::general:
            return fmt::format(
                "corrected for mirror images of neighbours by {:.4f} a RMS, as learned from {} "
                "other cameras; on test cameras, not on this film, errors fell from {:.4f} to "
                "{:.4f} a",
                decision.moved.value_or(0), decision.cameras, decision.before, decision.after);
        case BiasSource::film:
            return fmt::format(
                "corrected for mirror images of neighbours as learned from rendered frames: {:.4f} "
                "to {:.4f} a RMS per axis on those left out",
                decision.before, decision.after);
        case BiasSource::none:
            break;
    }
    return "not corrected for mirror images: " + decision.reason;
}

}  // namespace grainfield::tracking
