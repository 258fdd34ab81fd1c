#include "core/run_identity.h"

#include <fmt/format.h>

namespace grainfield {

const char* symbol(ControlParameter parameter) {
    return parameter == ControlParameter::acceleration ? "Γ" : "ν";
}

bool same_series(const RunIdentity& a, const RunIdentity& b) {
    return a.origin == b.origin && a.role == b.role && a.dimension == b.dimension &&
           a.gradient_order == b.gradient_order;
}

std::string series_text(const RunIdentity& identity) {
    switch (identity.origin) {
        case Origin::video:
            return "tracked";
        case Origin::rendered:
            return "true positions";
        case Origin::md:
            return "MD";
        case Origin::points:
            return "points";
        case Origin::field:
            break;
    }
    std::string text = fmt::format("field, {}D", identity.dimension);
    if (identity.gradient_order) text += fmt::format(", b = {:g}", *identity.gradient_order);
    return text;
}

std::string legend_of(const RunIdentity& identity) {
    std::string series = series_text(identity);
    if (!identity.control) return series;
    const ControlValue& control = *identity.control;
    const std::string unit =
        control.unit.is_dimensionless() ? "" : fmt::format(" {}", control.unit.text());
    return fmt::format("{}, {} = {:.4g}{}", series, symbol(control.parameter), control.value, unit);
}

}  // namespace grainfield
