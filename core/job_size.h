#pragma once

namespace grainfield {

/// What a job will need, estimated from its options before anything is allocated; true within
/// about a factor of two.
struct JobSize {
    double bytes = 0;    ///< of memory, at most at a time [B]
    double seconds = 0;  ///< of wall time [s]
};

}  // namespace grainfield
