#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/run_plan.h"
#include "report/figures/figure.h"
#include "report/figures/gnuplot.h"
#include "report/maps/particle_map.h"

namespace grainfield::report {

/// The figure's data in long form: `run,series,<x>,<y>,<y>_err`; guides are left out.
std::string figure_csv(const Figure& figure);

/// Writes every figure with data and every map as `<name>.csv`, `.svg` and `.pdf` into the folder,
/// which is made if needed; gives the names of the files written. Plots need gnuplot: without
/// it, or when it fails, the plan says so and everything else is written. The list `files.txt`
/// (last of the names) stays in the folder; the next report there removes what it names and does
/// not write again, and nothing else. Throws OutputError.
std::vector<std::string> write_figure_files(const std::vector<Figure>& figures,
                                            const std::vector<ParticleMap>& maps,
                                            const std::vector<std::string>& labels,
                                            const std::filesystem::path& folder,
                                            const Gnuplot& gnuplot, RunPlan& plan);

}  // namespace grainfield::report
