// An observable that the program does not have, added by the steps of CONTRIBUTING: its class, one
// line to register it, and this test. Nothing else knows its name.

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/analysis.h"
#include "analysis/order/shared_bond_order.h"
#include "analysis/recorded_options.h"
#include "analysis/run.h"
#include "analysis/statistics/blocks.h"
#include "core/errors.h"
#include "core/stored_trajectory.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

struct CrowdOptions {
    int least = 4;  ///< neighbours of a particle that counts [-]
};

OptionTable describe_crowd(CrowdOptions& options) {
    OptionTable table("crowd");
    table.integer("least", options.least, "-", {0, 100}, "neighbours of a particle that counts");
    return table;
}

// The number of particles per area that have at least so many neighbours.
class CrowdObservable final : public AccumulatorOf<CrowdObservable, double> {
 public:
    static constexpr const char* name = "crowd";
    static std::vector<Observable> needs(const AnalysisOptions& /*options*/) {
        return {observable_of<SharedBondOrder>()};
    }
    static std::optional<OptionTable> describe(AnalysisOptions& options) {
        return describe_crowd(options.of<CrowdOptions>());
    }
    static void plan(const PlanSetup& setup, RunPlan& plan) {
        plan.run("crowd", std::to_string(setup.frames) + " frames");
    }
    static std::vector<FigureHint> figures() {
        return {
            {.name = "crowd",
             .title = "Crowd",
             .note = "",
             .x = {"frame", "Frame", ""},
             .y = {"density", "Density", "1/a^2"},
             .series = {{.label = "crowd", .from = {"crowd", "crowd", "frame", "density", ""}}}}};
    }
    static ObservableTitles titles() {
        return {name, "Crowd", {{"crowd_density", "Density of the crowd"}}};
    }

    explicit CrowdObservable(const RunSetup& setup) : options_(setup.options.of<CrowdOptions>()) {}
    Sample measure(const Moment& moment) const {
        double count = 0;
        for (const int n : moment.sample_of<SharedBondOrder>()->neighbours) {
            count += n >= options_.least ? 1 : 0;
        }
        return count / moment.pattern().box.area();
    }
    void add(Sample& sample, const Moment& moment) {
        density_.add(sample);
        frame_.push_back(static_cast<double>(moment.pattern().frame));
    }
    void merge(const CrowdObservable& later) {
        density_.append(later.density_);
        frame_.insert(frame_.end(), later.frame_.begin(), later.frame_.end());
    }
    ObservableResult result(const Inputs& /*inputs*/) const override {
        ObservableResult result;
        result.name = name;
        CrowdOptions options = options_;
        result.options = recorded(describe_crowd(options));
        if (frame_.empty()) {
            result.reason = "no frames";
            return result;
        }
        result.measurements = {
            density_.measurement("crowd_density", "1/a^2", std::nullopt, "one frame: no error")};
        result.curves = {
            {"crowd",
             "Crowd",
             {{"frame", "-", "Frame", frame_}, {"density", "1/a^2", "Density", density_.value}},
             {}}};
        return result;
    }

 private:
    CrowdOptions options_;
    MeanSeries density_;
    std::vector<double> frame_;
};

std::vector<Observable> with_crowd() {
    std::vector<Observable> known = observables();
    known.push_back(observable_of<CrowdObservable>());
    return known;
}

// 144 particles of a square lattice of spacing 1.1 a in a periodic box: each has four neighbours.
Trajectory lattice(int frames) {
    RandomStream random(3, "lattice");
    Trajectory trajectory;
    for (int f = 0; f < frames; ++f) {
        Snapshot s;
        s.frame = f;
        s.time = f;
        s.box = square_box(13.2);
        s.position = square_lattice(12, 1.1, 0.02, random);
        s.id = identities(144);
        trajectory.snapshots.push_back(s);
    }
    return trajectory;
}

TEST(AddAnObservable, RunsBesideTheOthersAndIsFoundByItsName) {
    AnalysisOptions options;
    options.observables = {"crowd"};
    RunPlan plan;
    const Results results =
        measure(lattice(5), options, {.threads = 2, .plan = &plan}, with_crowd());
    ASSERT_EQ(results.observables.size(), 1U);
    const Measurement* density = results.find("crowd")->find_measurement("crowd_density");
    ASSERT_NE(density, nullptr);
    EXPECT_NEAR(*density->value, 1 / (1.1 * 1.1), 1e-12);
    EXPECT_THAT(plan.text(), testing::HasSubstr("5 frames"));
    EXPECT_EQ(results.frames, 5);
    EXPECT_EQ(results.particles_mean, 144);
}

TEST(AddAnObservable, TakesItsOptionsFromTheTableOfItsOwn) {
    AnalysisOptions options;
    const std::vector<OptionTable> tables = describe(options, with_crowd());
    EXPECT_EQ(tables.back().section(), "crowd");
    tables.back().set("least", std::int64_t{5});
    options.observables = {"crowd", "q4"};
    const Results results = measure(lattice(2), options, {.threads = 1}, with_crowd());
    EXPECT_EQ(*results.find("crowd")->find_measurement("crowd_density")->value, 0);
    EXPECT_EQ(results.find("crowd")->options.at(0).second, OptionValue(std::int64_t{5}));
    EXPECT_NE(results.find("q4"), nullptr);
}

TEST(AddAnObservable, IsDrawnByWhatItSays) {
    bool found = false;
    for (const FigureHint& hint : figure_hints(with_crowd())) found |= hint.name == "crowd";
    EXPECT_TRUE(found);
    EXPECT_EQ(quantity_title(titles(with_crowd()), "crowd", "crowd_density"),
              "Density of the crowd");
}

TEST(AddAnObservable, IsUnknownWhereItIsNotRegistered) {
    AnalysisOptions options;
    options.observables = {"crowd"};
    EXPECT_THROW(measure(lattice(1), options), OptionError);
}

// Counts how often the shared work is done.
class CountedWork final : public AccumulatorOf<CountedWork, int> {
 public:
    static constexpr const char* name = "counted work";
    static constexpr bool has_result = false;
    static inline int times = 0;
    explicit CountedWork(const RunSetup& /*setup*/) {}
    Sample measure(const Moment& /*moment*/) const { return ++times; }
    void add(Sample& /*sample*/, const Moment& /*moment*/) {}
    void merge(const CountedWork& /*later*/) {}
};

template <int number>
class UserOfWork final : public AccumulatorOf<UserOfWork<number>, int> {
 public:
    static constexpr const char* name = number == 0 ? "zero" : "one";
    static std::vector<Observable> needs(const AnalysisOptions& /*options*/) {
        return {observable_of<CountedWork>()};
    }
    explicit UserOfWork(const RunSetup& /*setup*/) {}
    int measure(const Moment& moment) const { return moment.sample_of<CountedWork>(); }
    void add(int& /*sample*/, const Moment& /*moment*/) {}
    void merge(const UserOfWork& /*later*/) {}
};

TEST(AddAnObservable, SharesTheWorkThatSeveralNeed) {
    CountedWork::times = 0;
    measure(lattice(3), {}, {.threads = 1},
            {observable_of<UserOfWork<0>>(), observable_of<UserOfWork<1>>()});
    EXPECT_EQ(CountedWork::times, 3);
}

// Every observable of the program and the new one: two halves of a run that are merged give the
// results of the whole, within rounding.
TEST(AddAnObservable, MergesLaterPartsOfARun) {
    const Trajectory trajectory = lattice(40);
    AnalysisOptions options;
    const Pattern first = pattern_of(trajectory.snapshots[0], 1);
    const auto run_over = [&](std::int64_t from, std::int64_t to) {
        analysis::Run run(with_crowd(), {.options = options,
                                         .info = trajectory.info,
                                         .box = first.box,
                                         .frames = to - from,
                                         .first = from,
                                         .whole = 40});
        for (std::int64_t f = from; f < to; ++f) {
            run.add(
                run.measure(pattern_of(trajectory.snapshots[static_cast<std::size_t>(f)], 1), f));
        }
        return run;
    };
    analysis::Run whole = run_over(0, 40);
    analysis::Run early = run_over(0, 20);
    analysis::Run late = run_over(20, 40);
    early.merge(late);
    const auto expected = whole.results();
    const auto merged = early.results();
    ASSERT_EQ(expected.size(), merged.size());
    for (std::size_t o = 0; o < expected.size(); ++o) {
        ASSERT_EQ(expected[o].measurements.size(), merged[o].measurements.size())
            << expected[o].name;
        EXPECT_EQ(expected[o].reason, merged[o].reason);
        for (std::size_t m = 0; m < expected[o].measurements.size(); ++m) {
            const Measurement& a = expected[o].measurements[m];
            const Measurement& b = merged[o].measurements[m];
            EXPECT_EQ(a.name, b.name);
            ASSERT_EQ(a.value.has_value(), b.value.has_value()) << a.name;
            if (a.value) {
                EXPECT_NEAR(*a.value, *b.value, 1e-9 * std::abs(*a.value) + 1e-12) << a.name;
            }
        }
    }
}

}  // namespace
}  // namespace grainfield::analysis
