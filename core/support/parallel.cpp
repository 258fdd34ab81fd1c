#include "core/support/parallel.h"

#include <algorithm>

#include <omp.h>

#include "core/support/team.h"

namespace grainfield {

int thread_count(int requested) {
    return requested > 0 ? requested : std::max(1, omp_get_num_procs());
}

void parallel_for(std::int64_t count, int threads, const std::function<void(std::int64_t)>& body) {
    const std::int64_t workers = std::min<std::int64_t>(thread_count(threads), count);
    on_team(static_cast<int>(workers), [&](Team& team) { team.for_each(count, body); });
}

}  // namespace grainfield
