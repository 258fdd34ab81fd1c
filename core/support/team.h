#pragma once

#include <cstdint>
#include <functional>

namespace grainfield {

/// Threads held together for many pieces of work that are too short to start threads for.
///
/// Between two pieces a thread that has nothing to do looks for work for some microseconds, then
/// sleeps, so that idle threads leave the processors to others.
class Team {
 public:
    /// How many threads there are: at most as many as were asked for.
    virtual int threads() const = 0;

    /// Runs body(first, last) on consecutive parts of [0, count), one part a thread, and returns
    /// when all are done. Results must not depend on where the parts begin. The exception of the
    /// lowest part that failed is rethrown.
    virtual void split(std::int64_t count,
                       const std::function<void(std::int64_t, std::int64_t)>& body) = 0;

    /// As parallel_for, on the threads of this team.
    virtual void for_each(std::int64_t count, const std::function<void(std::int64_t)>& body) = 0;

 protected:
    ~Team() = default;
};

/// Calls `body` once, on this thread, with a team of up to `threads` threads, this one included.
/// Rethrows what it throws. The team hands out one piece of work at a time, and to `body` only.
///
/// A program that holds a team for all of its work starts threads once: parallel_for and on_team
/// inside `body` use it. Between regions OpenMP itself keeps idle threads running for milliseconds
/// (OMP_WAIT_POLICY), which harms where other programs want the processors.
void on_team(int threads, const std::function<void(Team&)>& body);

}  // namespace grainfield
