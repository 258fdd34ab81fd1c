#include "analysis/run.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace grainfield::analysis {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the time of a stage to `seconds` when it ends.
class Stopwatch {
 public:
    explicit Stopwatch(double& seconds) : seconds_(seconds) {}
    ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

 private:
    double& seconds_;
    Clock::time_point start_ = Clock::now();
};

// One snapshot with the samples that were measured of it so far.
class MeasuredMoment final : public Moment {
 public:
    MeasuredMoment(const Run::Measured& measured, const std::vector<std::type_index>& types,
                   const Inputs& inputs)
        : Moment(measured.pattern, measured.ordinal, inputs), measured_(measured), types_(types) {}

 private:
    const AnySample& sample(std::type_index type) const override {
        for (std::size_t i = 0; i < measured_.samples.size(); ++i) {
            if (types_[i] == type) return *measured_.samples[i];
        }
        throw std::logic_error("an observable asks for a sample that is not among its needs");
    }

    const Run::Measured& measured_;
    const std::vector<std::type_index>& types_;
};

}  // namespace

Run::Run(const std::vector<Observable>& wanted, const RunSetup& setup) {
    for (const Observable& observable : wanted) place(observable, setup, true);
    for (const Part& part : parts_) types_.push_back(part.observable.type);
}

void Run::place(const Observable& observable, const RunSetup& setup, bool is_wanted) {
    const auto found = std::ranges::find_if(
        parts_, [&](const Part& part) { return part.observable.type == observable.type; });
    if (found != parts_.end()) {
        found->is_wanted = found->is_wanted || is_wanted;
        return;
    }
    for (const Observable& need : observable.needs(setup.options)) place(need, setup, false);
    parts_.push_back(
        {.observable = observable, .accumulator = observable.start(setup), .is_wanted = is_wanted});
}

std::size_t Run::place_of(std::type_index type) const {
    const auto found = std::ranges::find(types_, type);
    if (found == types_.end()) {
        throw std::logic_error("an observable asks for another that is not among its needs");
    }
    return static_cast<std::size_t>(found - types_.begin());
}

Run::Measured Run::measure(Pattern pattern, std::int64_t ordinal) const {
    Measured measured;
    measured.pattern = std::move(pattern);
    measured.ordinal = ordinal;
    measured.seconds.assign(parts_.size(), 0.0);
    measured.samples.reserve(parts_.size());
    const MeasuredMoment moment(measured, types_, *this);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Stopwatch watch(measured.seconds[i]);
        measured.samples.push_back(parts_[i].accumulator->measure_any(moment));
    }
    return measured;
}

void Run::add(Measured measured) {
    dropped_ += measured.pattern.dropped;
    const MeasuredMoment moment(measured, types_, *this);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        parts_[i].seconds += measured.seconds[i];
        const Stopwatch watch(parts_[i].seconds);
        parts_[i].accumulator->add_any(*measured.samples[i], moment);
    }
}

void Run::finish() {
    if (std::exchange(is_finished_, true)) return;
    for (Part& part : parts_) {
        const Stopwatch watch(part.seconds);
        part.accumulator->finish(*this);
    }
}

void Run::merge(Run& later) {
    if (types_ != later.types_) throw std::logic_error("runs of different observables");
    finish();
    later.finish();
    dropped_ += later.dropped_;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        parts_[i].accumulator->merge_any(*later.parts_[i].accumulator);
        parts_[i].seconds += later.parts_[i].seconds;
    }
}

void Run::save(Checkpoint& checkpoint) const {
    checkpoint.integers["dropped"] = {dropped_};
    for (const Part& part : parts_) {
        const std::string prefix = part.observable.name + "/";
        checkpoint.reals[prefix + "seconds"] = {part.seconds};
        part.accumulator->save(checkpoint, prefix);
    }
}

void Run::restore(const Checkpoint& checkpoint) {
    const auto dropped = checkpoint.integers.find("dropped");
    if (dropped != checkpoint.integers.end() && dropped->second.size() == 1) {
        dropped_ = dropped->second[0];
    }
    for (Part& part : parts_) {
        const std::string prefix = part.observable.name + "/";
        const auto seconds = checkpoint.reals.find(prefix + "seconds");
        if (seconds != checkpoint.reals.end() && seconds->second.size() == 1) {
            part.seconds = seconds->second[0];
        }
        part.accumulator->restore(checkpoint, prefix);
    }
}

const Accumulator& Run::accumulator(std::type_index type) const {
    return *parts_[place_of(type)].accumulator;
}

const ObservableResult& Run::result(std::type_index type) const {
    return *results_[place_of(type)];
}

std::vector<ObservableResult> Run::results() {
    finish();
    results_.clear();
    std::vector<ObservableResult> results;
    double shared = 0;  // what was done for the next observable that is wanted
    for (Part& part : parts_) {
        results_.emplace_back();
        if (part.observable.has_result) {
            const Stopwatch watch(part.seconds);
            results_.back() = part.accumulator->result(*this);
        }
        if (!part.is_wanted) {
            shared += part.seconds;
            continue;
        }
        results.push_back(*results_.back());
        results.back().seconds = part.seconds + std::exchange(shared, 0.0);
    }
    return results;
}

}  // namespace grainfield::analysis
