#include "app/session.h"

#include "core/support/parallel.h"

namespace grainfield::app {

void Session::apply(const CommonOptions& options) {
    common = options;
    threads = thread_count(options.threads);
    seed = static_cast<std::uint64_t>(options.seed);
    verbosity = options.verbosity();
    size_check = options.force_size ? pipelines::SizeCheck::insist : pipelines::SizeCheck::refuse;
    overwrite = options.force ? Overwrite::force : Overwrite::refuse;
}

}  // namespace grainfield::app
