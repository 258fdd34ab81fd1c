#pragma once

#include <chrono>

namespace grainfield::tracking {

/// What the times of a run are measured with (FrameTimes).
using RunClock = std::chrono::steady_clock;

inline double milliseconds_since(RunClock::time_point start) {
    return 1e3 * std::chrono::duration<double>(RunClock::now() - start).count();
}

}  // namespace grainfield::tracking
