#include "simulate/field/field_plan.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/parallel.h"

namespace grainfield::simulate {
namespace {

using ::testing::HasSubstr;

bool skips(const RunPlan& plan, const std::string& what) {
    return std::ranges::any_of(plan.stages(), [&](const PlannedStage& stage) {
        return !stage.runs && stage.stage.find(what) != std::string::npos;
    });
}

TEST(FieldOptions, NameTheModelAndItsDistanceToTheCriticalPoint) {
    FieldOptions options;
    options.model.nu = 0.002;
    options.model.b = 2;
    options.lattice.dimension = 1;
    EXPECT_EQ(legend_of(identity_of(options)), "field, 1D, b = 2, ν = 0.002");
}

TEST(FieldPlan, TakesTheExplicitSchemeOnlyBelowItsBound) {
    FieldOptions options;
    RunPlan plan;
    EXPECT_EQ(plan_field(options, plan).setup.scheme, FieldScheme::lod);
    options.scheme.dt = 0.05;
    EXPECT_EQ(plan_field(options, plan).setup.scheme, FieldScheme::explicit_lm);
    options.lattice.dimension = 1;
    options.lattice.spacing = 0.25;
    EXPECT_EQ(plan_field(options, plan).setup.scheme, FieldScheme::lod);
}

TEST(FieldPlan, SkipsWhatTheSceneDoesNotNeed) {
    FieldOptions options;
    options.model.lambda = 0;
    RunPlan plan;
    EXPECT_FALSE(plan_field(options, plan).setup.has_order);
    EXPECT_TRUE(skips(plan, "order field"));

    RunPlan second;
    options = {};
    const FieldPlan normal = plan_field(options, second);
    EXPECT_TRUE(skips(second, "order modes above"));
    EXPECT_TRUE(skips(second, "Gaussian"));
    EXPECT_TRUE(skips(second, "double precision"));
    EXPECT_NEAR(normal.setup.k_cut, 2.05, 0.1);

    RunPlan third;
    options.scheme.tolerance = 0;
    options.record.store = 10;
    const FieldPlan exact = plan_field(options, third);
    EXPECT_FALSE(skips(third, "order modes"));
    EXPECT_FALSE(skips(third, "Gaussian"));
    EXPECT_FALSE(skips(third, "double"));
    EXPECT_TRUE(exact.setup.twofold);
    EXPECT_EQ(exact.setup.noise, NoiseShape::normal);
    EXPECT_EQ(exact.setup.hold, 1);
}

// Replacing ψ by its average needs modes faster than the density: with b = 2 or a large D0 they
// are not.
TEST(FieldPlan, KeepsModesThatAreNotFasterThanTheDensity) {
    FieldOptions options;
    options.model.b = 2;
    RunPlan one;
    plan_field(options, one);
    EXPECT_FALSE(skips(one, "order modes above"));
    options = {};
    options.model.d0 = 3;
    RunPlan two;
    EXPECT_NEAR(plan_field(options, two).setup.k_cut, std::sqrt(12.0), 0.05);
}

TEST(FieldPlan, RefusesStepsThatNoLineSolverCanTake) {
    FieldOptions options;
    options.model.d0 = 1e12;
    RunPlan plan;
    EXPECT_THROW(plan_field(options, plan), OptionError);
}

TEST(FieldPlan, HoldsTheOrderFieldWhereStepsAreShort) {
    FieldOptions options;
    options.scheme.dt = 0.02;
    RunPlan plan;
    EXPECT_GT(plan_field(options, plan).setup.hold, 3);
    EXPECT_TRUE(skips(plan, "order field between"));
    options.scheme.hold = 1;
    EXPECT_EQ(plan_field(options, plan).setup.hold, 1);
}

TEST(FieldPlan, TakesAsManyThreadsAsPay) {
    FieldOptions options;
    options.threads = 8;
    options.lattice.nx = 64;
    RunPlan plan;
    EXPECT_EQ(plan_field(options, plan).threads, 1);
    options.lattice.nx = 1024;
    EXPECT_EQ(plan_field(options, plan).threads, std::min(8, thread_count(0)));
}

TEST(FieldPlan, RefusesWhatCannotBe) {
    const auto refused = [](auto change) {
        FieldOptions options;
        change(options);
        RunPlan plan;
        try {
            plan_field(options, plan);
        } catch (const OptionError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_THAT(refused([](auto& o) { o.model.b = 3; }), HasSubstr("even"));
    EXPECT_THAT(refused([](auto& o) { o.lattice.ny = 1; }), HasSubstr("dimension = 1"));
    EXPECT_THAT(refused([](auto& o) {
                    o.lattice.dimension = 1;
                    o.lattice.ny = 5;
                }),
                HasSubstr("ny = 5"));
    EXPECT_THAT(refused([](auto& o) {
                    o.scheme.scheme = SchemeChoice::adjoint;
                    o.scheme.waves = {1, 0};
                }),
                HasSubstr("waves"));
}

TEST(FieldPlan, WarnsWhereThereIsNoStationaryState) {
    FieldOptions options;
    options.model.nu = 0;
    options.model.d0 = 0;
    RunPlan plan;
    plan_field(options, plan);
    ASSERT_EQ(plan.warnings().size(), 2U);
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("nu = 0"));
    EXPECT_THAT(plan.warnings()[1].text, HasSubstr("d0 = 0"));
}

}  // namespace
}  // namespace grainfield::simulate
