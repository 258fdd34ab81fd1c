#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <typeindex>
#include <utility>

#include "analysis/pattern.h"
#include "core/results.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

class Accumulator;
class Moment;

/// The accumulators and results that others may take as inputs, by the type of the accumulator.
class Inputs {
 public:
    virtual ~Inputs() = default;

    template <class A>
    const A& of() const {
        return static_cast<const A&>(accumulator(typeid(A)));
    }
    template <class A>
    const ObservableResult& result_of() const {
        return result(typeid(A));
    }

 private:
    virtual const Accumulator& accumulator(std::type_index type) const = 0;
    virtual const ObservableResult& result(std::type_index type) const = 0;
};

/// What one snapshot contributes to one observable, whatever its type.
class AnySample {
 public:
    virtual ~AnySample() = default;
};

template <class Sample>
class StoredSample final : public AnySample {
 public:
    explicit StoredSample(Sample sample) : value(std::move(sample)) {}
    Sample value;
};

/// One observable in one run: a streaming accumulator, seen without its type. Observables derive
/// from AccumulatorOf.
class Accumulator {
 public:
    virtual ~Accumulator() = default;
    virtual std::unique_ptr<AnySample> measure_any(const Moment& moment) const = 0;
    virtual void add_any(AnySample& sample, const Moment& moment) = 0;
    virtual void merge_any(const Accumulator& later) = 0;
    /// Called once, before it is merged and after the last snapshot and before any result.
    virtual void finish(const Inputs& /*inputs*/) {}
    virtual ObservableResult result(const Inputs& inputs) const = 0;
    /// What was gathered, under names that begin with `prefix`; `restore` takes it into an
    /// accumulator of the same setup. Only of observables that can be saved. Throws InputError if
    /// it does not fit.
    virtual void save(Checkpoint& /*checkpoint*/, const std::string& /*prefix*/) const {}
    virtual void restore(const Checkpoint& /*checkpoint*/, const std::string& /*prefix*/) {}
};

/// One snapshot on its way through the observables of a run.
class Moment {
 public:
    Moment(const Pattern& pattern, std::int64_t ordinal, const Inputs& inputs)
        : pattern_(pattern), ordinal_(ordinal), inputs_(inputs) {}
    virtual ~Moment() = default;

    const Pattern& pattern() const { return pattern_; }
    std::int64_t ordinal() const { return ordinal_; }  ///< number of the snapshot in its run

    /// What accumulator A, which must be among the needs, measured of this snapshot.
    template <class A>
    const typename A::Sample& sample_of() const {
        return static_cast<const StoredSample<typename A::Sample>&>(sample(typeid(A))).value;
    }

    /// Accumulator A, which has this snapshot already. Only while snapshots are added.
    template <class A>
    const A& of() const {
        return inputs_.of<A>();
    }

 private:
    virtual const AnySample& sample(std::type_index type) const = 0;

    const Pattern& pattern_;
    std::int64_t ordinal_;
    const Inputs& inputs_;
};

}  // namespace grainfield::analysis
