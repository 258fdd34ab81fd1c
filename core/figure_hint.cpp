#include "core/figure_hint.h"

namespace grainfield {

RunUnit run_unit(const Unit& unit, TimeUnit time) {
    if (unit.power(BaseUnit::time) == 0) return {unit};
    return {unit, time};
}

std::string Axis::unit_text() const {
    if (units.empty()) return typeset_text(unit);
    std::string text;
    for (const RunUnit& own : units) {
        const std::string one =
            own.time ? typeset_text(own.unit, *own.time) : typeset_text(own.unit);
        text += (text.empty() ? "" : " or ") + one;
    }
    return text;
}

std::string Axis::title() const {
    const std::string unit_name = unit_text();
    return unit_name.empty() ? label : label + " [" + unit_name + "]";
}

}  // namespace grainfield
