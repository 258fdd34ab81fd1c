#pragma once

#include <optional>
#include <string>

namespace grainfield {

/// Standard gravity g [m/s²].
constexpr double standard_gravity = 9.80665;

/// Seconds in sqrt(a/g), the time unit of molecular dynamics, for spheres of diameter a [mm].
double seconds_of_time_unit(double sphere_mm);

/// Γ = (2πf)² A/g of a vibration z = A sin 2πft, f [Hz], A [mm].
double acceleration_of(double frequency_hz, double amplitude_mm);

/// What a lab knows of its cell, in its own units. Empty: not known.
struct LabUnits {
    std::optional<double> sphere_mm;     ///< true diameter a of the spheres [mm]
    std::optional<double> gamma;         ///< Γ = Aω²/g of the vibration
    std::optional<double> frequency;     ///< of the vibration [Hz]
    std::optional<double> amplitude_mm;  ///< A of the vibration [mm]

    /// Γ as given, or from frequency and amplitude; empty if neither is known. Throws OptionError
    /// if both are known and contradict each other.
    std::optional<double> acceleration() const;
};

/// Throws OptionError, with both values, unless two statements of one quantity agree within 1 %,
/// the rounding of what a lab writes down. `first`, `second`: where each comes from, in words.
void require_agreement(const std::string& quantity, const std::string& first, double first_value,
                       const std::string& second, double second_value);

}  // namespace grainfield
