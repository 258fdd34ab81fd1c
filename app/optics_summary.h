#pragma once

#include "app/command.h"
#include "pipelines/render/optics_use.h"

namespace grainfield::app {

/// Adds to `summary` what the optics took. For silhouettes the counts are 0 and no line is added.
void add_optics_summary(const pipelines::OpticsUse& use, Summary& summary);

}  // namespace grainfield::app
