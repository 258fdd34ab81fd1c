#include "report/page/paper_table.h"

namespace grainfield::report {

// From the text of castillo2019; docs/paper.md says what each means and where the text is
// ambiguous.
const std::vector<PaperValue>& paper_values() {
    static const std::vector<PaperValue> values{
        {"Γc, experiment", "critical", "tracked", "critical", "critical_value", 4.73, 0.15},
        {"Γc, experiment (true positions)", "critical", "true positions", "critical",
         "critical_value", 4.73, 0.15},
        {"Γc, molecular dynamics (A = 0.092(1) a)", "critical", "MD", "critical", "critical_value",
         2.30, 0.025},
        {"α, field model, 2D, b = 4", "critical", "field, 2D, b = 4", "critical", "alpha", 1.12,
         0.15},
        {"α, field model, 1D, b = 2", "critical", "field, 1D, b = 2", "critical", "alpha", 1.58,
         0.10},
        {"α, field model, 1D, b = 4", "critical", "field, 1D, b = 4", "critical", "alpha", 1.58,
         0.10},
        {"Pre-peak k_pp a, experiment", "tracked", "", "fit", "k_pre_peak", 0.2, 0.05, true},
        {"|Q₄| of the wide maximum, experiment", "tracked", "", "q4", "q4_low_mode", 0.3, 0.05,
         true},
        {"|Q₄| of the narrow maximum, experiment", "tracked", "", "q4", "q4_high_mode", 0.95, 0.025,
         true},
        {"|Q₄| of the minimum between them", "tracked", "", "q4", "q4_minimum", 0.7, 0.05, true},
        {"MSD exponent of the liquid, experiment", "tracked", "", "msd", "exponent_liquid", 1, 0.05,
         true}};
    return values;
}

}  // namespace grainfield::report
