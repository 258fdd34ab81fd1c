#include "app/common_options.h"

namespace grainfield::app {

OptionTable describe(CommonOptions& options) {
    OptionTable table("");
    table.integer("threads", options.threads, "-", {0, 4096},
                  "threads to use, 0 for all of the machine; does not change results");
    table.affects(Effect::work);
    table.integer("seed", options.seed, "-", {0, 9e18}, "seed of all random streams");
    table.flag("explain", options.explain, "print what would be done and why, then stop");
    table.affects(Effect::work);
    table.flag("json", options.json, "print the summary as one JSON object on standard output");
    table.affects(Effect::work);
    table.flag("quiet", options.quiet, "no progress and no summary");
    table.affects(Effect::work);
    table.flag("verbose", options.verbose, "also list the stages that ran");
    table.affects(Effect::work);
    table.flag("force", options.force, "replace an output that exists");
    table.affects(Effect::work);
    table.flag("force-size", options.force_size,
               "begin a run that seems to need more memory or time than there is");
    table.affects(Effect::work);
    return table;
}

}  // namespace grainfield::app
