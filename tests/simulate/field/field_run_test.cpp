#include "simulate/field/field_run.h"

#include <gtest/gtest.h>

#include "simulate/field/integrators/integrator_choice.h"
#include "tests/simulate/field/integrators/field_checks.h"

namespace grainfield::simulate {
namespace {

struct Steps : FieldSink {
    std::vector<std::int64_t> step;
    std::vector<std::vector<double>> value;
    void write(const FieldFrame& frame) override {
        step.push_back(frame.density.front().step);
        value.push_back(frame.density.front().value);
    }
};

TEST(FieldRun, SamplesAndStoresOnSchedule) {
    const FieldSetup setup = testing::plane(8, 8, FieldScheme::lod, 0.5);
    const FieldSchedule schedule{10, 4, 5, 7};
    EXPECT_EQ(schedule.total(), 30);
    const auto fields = make_integrator(setup, 1);
    Steps samples, stored;
    FieldRun run(*fields, schedule, samples, stored);
    while (!run.is_done()) run.advance(1000);
    EXPECT_EQ(samples.step, (std::vector<std::int64_t>{15, 20, 25, 30}));
    EXPECT_EQ(stored.step, (std::vector<std::int64_t>{17, 24, 30}));

    const auto again = make_integrator(setup, 1);
    Steps one_by_one, other;
    FieldRun slow(*again, schedule, one_by_one, other);
    while (!slow.is_done()) EXPECT_EQ(slow.advance(1), 1);
    EXPECT_EQ(one_by_one.step, samples.step);
    EXPECT_EQ(one_by_one.value, samples.value);
    EXPECT_EQ(other.value, stored.value);
}

TEST(FieldRun, WithoutAnIntervalOnlyTheLastFieldIsStored) {
    const auto fields = make_integrator(testing::plane(8, 8, FieldScheme::lod, 0.5), 1);
    Steps samples, stored;
    FieldRun run(*fields, {0, 3, 2, 0}, samples, stored);
    while (!run.is_done()) run.advance(3);
    EXPECT_EQ(stored.step, std::vector<std::int64_t>{6});
    EXPECT_EQ(run.advance(10), 0);
}

}  // namespace
}  // namespace grainfield::simulate
