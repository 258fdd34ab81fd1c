#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/lab_units.h"
#include "core/option_table.h"
#include "core/results.h"
#include "core/run_plan.h"
#include "core/trajectory.h"

namespace grainfield::pipelines {

/// Adds the rows sphere-mm, gamma, vibration-frequency and amplitude-mm of a film to a command's
/// own table. No position depends on them.
void describe(LabUnits& lab, OptionTable& table);

/// Empties what `lab` has from a file where the command line, which wins, says the vibration in
/// other words: of Γ, frequency and amplitude two make the third. With Γ on the command line the
/// amplitude goes, or the frequency if the amplitude is given there; with frequency and amplitude Γ
/// goes. `is_given`: whether the option of that name is on the command line.
void make_room_for(LabUnits& lab, const std::function<bool(const std::string& name)>& is_given);

/// What a trajectory says of itself because of it: the control parameter Γ, and the frequency of
/// the vibration where times are in seconds. Throws OptionError for contradictions.
void apply(const LabUnits& lab, TrajectoryInfo& info);

/// All that is known, to go with a trajectory: `lab_units_in` reads it again. Nothing if nothing is
/// known.
std::optional<Curve> curve_of(const LabUnits& lab);

/// What the curves of a trajectory say; Γ is not among them (TrajectoryInfo::control).
LabUnits lab_units_in(const std::vector<Curve>& curves);

/// Where the frame rate of a film comes from.
enum class RateSource { given, file, live, unknown };

/// "25 frames a second, from the file: is that the filming rate?"
std::string rate_in_words(const TrajectoryInfo& info, RateSource source);

/// "10.09 px a sphere, given; spheres of 1 mm: 1 px is 0.09911 mm": of a film.
std::string scale_in_words(const TrajectoryInfo& info, const LabUnits& lab);

/// The three, a line each, for a summary; options as `plan` calls them.
std::string units_in_words(const TrajectoryInfo& info, RateSource source, const LabUnits& lab,
                           const RunPlan& plan);

/// "Γ = 4.5, 80 Hz, 0.08 mm"; empty if nothing is known.
std::string vibration_in_words(const TrajectoryInfo& info, const LabUnits& lab);

}  // namespace grainfield::pipelines
