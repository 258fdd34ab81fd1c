#include "core/lab_units.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

constexpr double kRounding = 0.01;

}  // namespace

double seconds_of_time_unit(double sphere_mm) {
    return std::sqrt(1e-3 * sphere_mm / standard_gravity);
}

double acceleration_of(double frequency_hz, double amplitude_mm) {
    const double omega = 2 * M_PI * frequency_hz;
    return omega * omega * 1e-3 * amplitude_mm / standard_gravity;
}

std::optional<double> LabUnits::acceleration() const {
    if (!frequency || !amplitude_mm) return gamma;
    const double made = acceleration_of(*frequency, *amplitude_mm);
    if (!gamma) return made;
    require_agreement(
        "the acceleration of the vibration", "option 'gamma'", *gamma,
        fmt::format("{:g} Hz with an amplitude of {:g} mm", *frequency, *amplitude_mm), made);
    return gamma;
}

void require_agreement(const std::string& quantity, const std::string& first, double first_value,
                       const std::string& second, double second_value) {
    const double scale = std::max(std::abs(first_value), std::abs(second_value));
    if (std::abs(first_value - second_value) <= kRounding * scale) return;
    throw OptionError(
        {.problem = fmt::format("{} is given twice, with two values", quantity),
         .actual = fmt::format("{}: {:.6g}; {}: {:.6g}", first, first_value, second, second_value),
         .expected = "values that agree within 1 %",
         .suggestion = "leave one of them out"});
}

}  // namespace grainfield
