#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/run_plan.h"
#include "core/support/checkpoint.h"

namespace grainfield::tracking {

/// Warnings of single frames, gathered: what is true of many frames is said once, with how many,
/// the first and the last of them. Texts that differ in their numbers only are the same; those of
/// the first frame are said.
class RepeatedWarnings {
 public:
    void add(std::int64_t frame, std::string text);
    /// "film.mp4, frame 3: dark", "film.mp4, 42 frames from 3 to 44: dark".
    void say(const std::string& film, RunPlan& plan) const;

    void save(Checkpoint& checkpoint) const;
    /// Goes on from a saved run. Throws InputError if its lists do not belong together.
    void restore(const Checkpoint& checkpoint);

 private:
    struct Kind {
        std::string text;
        std::int64_t first = 0, last = 0, count = 1;
    };
    std::vector<Kind> kinds_;
};

}  // namespace grainfield::tracking
