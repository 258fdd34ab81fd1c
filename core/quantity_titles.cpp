#include "core/quantity_titles.h"

#include <algorithm>

namespace grainfield {

namespace {

std::string with_spaces(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

}  // namespace

std::string quantity_title(const std::vector<ObservableTitles>& titles,
                           const std::string& observable, const std::string& measurement) {
    for (const ObservableTitles& known : titles) {
        if (known.name != observable) continue;
        const auto found = std::ranges::find(known.quantities, measurement, &QuantityTitle::name);
        if (found != known.quantities.end()) return found->title;
        for (const QuantityFamily& family : known.families) {
            if (!measurement.starts_with(family.prefix)) continue;
            return family.before + measurement.substr(family.prefix.size()) + family.after;
        }
    }
    return with_spaces(measurement);
}

std::string observable_title(const std::vector<ObservableTitles>& titles,
                             const std::string& observable) {
    const auto found = std::ranges::find(titles, observable, &ObservableTitles::name);
    return found == titles.end() ? with_spaces(observable) : found->title;
}

}  // namespace grainfield
