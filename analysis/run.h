#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/observable.h"

namespace grainfield::analysis {

/// The observables of one run with what they need of each other, each measured once.
class Run final : private Inputs {
 public:
    /// What the threads made of one snapshot.
    struct Measured {
        Pattern pattern;
        std::int64_t ordinal = 0;
        std::vector<std::unique_ptr<AnySample>> samples;
        std::vector<double> seconds;
    };

    /// `wanted`: those that give results.
    Run(const std::vector<Observable>& wanted, const RunSetup& setup);

    /// Of snapshot number `ordinal` of the run. Thread-safe.
    Measured measure(Pattern pattern, std::int64_t ordinal) const;

    /// Takes snapshots in order.
    void add(Measured measured);

    /// Adds what another run of the same observables gathered from the snapshots that follow. No
    /// snapshot can be added to either after that.
    void merge(Run& later);

    /// What all observables have gathered; `restore` takes it into a run of the same setup that has
    /// no snapshots. Throws InputError if it does not fit.
    void save(Checkpoint& checkpoint) const;
    void restore(const Checkpoint& checkpoint);

    /// The results of the wanted observables, in their order. Nothing can be added after that.
    std::vector<ObservableResult> results();

    /// Positions that were left out because they are not finite.
    std::int64_t dropped() const { return dropped_; }

 private:
    struct Part {
        Observable observable;
        std::unique_ptr<Accumulator> accumulator;
        bool is_wanted = false;
        double seconds = 0;
    };
    void place(const Observable& observable, const RunSetup& setup, bool is_wanted);
    void finish();
    std::size_t place_of(std::type_index type) const;
    const Accumulator& accumulator(std::type_index type) const override;
    const ObservableResult& result(std::type_index type) const override;

    std::vector<Part> parts_;  // each after those that it needs
    std::vector<std::type_index> types_;
    std::vector<std::optional<ObservableResult>> results_;
    std::int64_t dropped_ = 0;
    bool is_finished_ = false;
};

}  // namespace grainfield::analysis
