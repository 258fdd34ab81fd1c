#include "core/results.h"

#include <algorithm>

namespace grainfield {

namespace {

template <class Named>
const Named* find_by_name(const std::vector<Named>& items, const std::string& name) {
    const auto found = std::ranges::find(items, name, &Named::name);
    return found == items.end() ? nullptr : &*found;
}

}  // namespace

const Column* Curve::find(const std::string& column) const {
    return find_by_name(columns, column);
}

const Curve* ObservableResult::find_curve(const std::string& curve) const {
    return find_by_name(curves, curve);
}

const Measurement* ObservableResult::find_measurement(const std::string& measurement) const {
    return find_by_name(measurements, measurement);
}

const OptionValue* ObservableResult::find_option(const std::string& option) const {
    for (const auto& [recorded, value] : options) {
        if (recorded == option) return &value;
    }
    return nullptr;
}

const ObservableResult* Results::find(const std::string& observable) const {
    return find_by_name(observables, observable);
}

}  // namespace grainfield
