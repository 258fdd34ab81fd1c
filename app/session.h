#pragma once

#include "app/common_options.h"
#include "pipelines/job.h"

namespace grainfield::app {

using pipelines::counted;

/// One call of the program: the job that its pipeline gets, and how to talk about it.
struct Session : pipelines::Job {
    CommonOptions common;

    /// Takes what every command understands, and gives the job its part of it.
    void apply(const CommonOptions& options);
};

}  // namespace grainfield::app
