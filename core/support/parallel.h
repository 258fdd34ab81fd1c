#pragma once

#include <cstdint>
#include <functional>

namespace grainfield {

/// The number of threads to use: `requested` if positive, else the number the machine offers.
int thread_count(int requested);

/// Runs body(i) for i in [0, count) on up to `threads` threads, any order. Results must not depend
/// on the order: let each i own its output. If bodies throw, the exception of the smallest i is
/// rethrown here after all threads have stopped; later bodies may then not have run.
void parallel_for(std::int64_t count, int threads, const std::function<void(std::int64_t)>& body);

}  // namespace grainfield
