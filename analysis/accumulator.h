#pragma once

#include <concepts>
#include <utility>

#include "core/results.h"

namespace grainfield::analysis {

/// What every observable is: a streaming accumulator.
///
/// The work of a frame has two halves, so that frames can be measured by many threads and still
/// give the same bits for any number of them:
///   1. a pure function makes a `Sample` from one pattern (heavy; any thread, any order);
///   2. `add` takes the samples in the order of the frames (light; one thread).
/// `merge` adds what another accumulator, built with the same options, gathered from later frames
/// (another file, another block). `result` may be called at any time and changes nothing.
///
/// Memory must not grow with the number of frames beyond what the class comment states.
template <class A>
concept Accumulator = requires(A accumulator, const A& other, typename A::Sample sample) {
    accumulator.add(std::move(sample));
    accumulator.merge(other);
    { other.result() } -> std::same_as<ObservableResult>;
};

}  // namespace grainfield::analysis
