#pragma once

#include "analysis/analysis_options.h"
#include "analysis/pairs/pair_distribution.h"
#include "simulate/field/integrators/field_integrator.h"
#include "simulate/md/md_options.h"

namespace grainfield::fuzz {

/// The jobs that the seeds of `read_checkpoints` are states of.
inline simulate::MdOptions md_options() {
    simulate::MdOptions options;
    options.cell.grains = 12;
    options.cell.length_x = options.cell.length_y = 6;
    options.run.periods = 4;
    return options;
}

inline simulate::FieldSetup field_setup() {
    simulate::FieldSetup setup;
    setup.lattice = {2, 8, 8, 0.65};
    setup.k_cut = 1e9;
    return setup;
}

inline analysis::AnalysisOptions part_options() {
    analysis::AnalysisOptions options;
    options.observables = {"sk", "s4", "variance", "gr", "height"};
    options.of<analysis::PairDistributionOptions>().bin = 0.5;  // a small seed
    return options;
}

}  // namespace grainfield::fuzz
