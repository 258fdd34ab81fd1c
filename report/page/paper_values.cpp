#include "report/page/paper_table.h"

namespace grainfield::report {

namespace {

RunIdentity critical_point(RunIdentity series) {
    series.role = RunRole::critical_point;
    return series;
}

RunIdentity field_of(int dimension, double b) {
    return {.origin = Origin::field, .dimension = dimension, .gradient_order = b};
}

}  // namespace

// From the text of castillo2019; docs/paper.md says what each means and where the text is
// ambiguous.
const std::vector<PaperValue>& paper_values() {
    const RunIdentity tracked{.origin = Origin::video};
    const RunIdentity true_positions{.origin = Origin::rendered};
    const RunIdentity md{.origin = Origin::md};
    static const std::vector<PaperValue> values{
        {"Γc, experiment", critical_point(tracked), "critical", "critical_value", 4.73, 0.15, false,
         "2b"},
        {"Γc, experiment (true positions)", critical_point(true_positions), "critical",
         "critical_value", 4.73, 0.15},
        {"Γc, molecular dynamics (A = 0.092(1) a)", critical_point(md), "critical",
         "critical_value", 2.30, 0.025, false, "2e"},
        {"α, field model, 2D, b = 4", critical_point(field_of(2, 4)), "critical", "alpha", 1.12,
         0.15, false, "2g"},
        {"α, field model, 1D, b = 2", critical_point(field_of(1, 2)), "critical", "alpha", 1.58,
         0.10},
        {"α, field model, 1D, b = 4", critical_point(field_of(1, 4)), "critical", "alpha", 1.58,
         0.10},
        {"Pre-peak k_pp a, experiment", tracked, "fit", "k_pre_peak", 0.2, 0.05, true, "2a"},
        {"|Q₄| of the wide maximum, experiment", tracked, "q4", "q4_low_mode", 0.3, 0.05, true,
         "1b"},
        {"|Q₄| of the narrow maximum, experiment", tracked, "q4", "q4_high_mode", 0.95, 0.025, true,
         "1b"},
        {"|Q₄| of the minimum between them", tracked, "q4", "q4_minimum", 0.7, 0.05, true, "1b"},
        {"MSD exponent of the liquid, experiment", tracked, "msd", "exponent_liquid", 1, 0.05, true,
         "3"}};
    return values;
}

}  // namespace grainfield::report
