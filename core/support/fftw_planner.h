#pragma once

#include <mutex>

namespace grainfield {

/// FFTW's planner works for one thread at a time: code that makes or destroys plans holds this.
std::mutex& fftw_planner_mutex();

}  // namespace grainfield
