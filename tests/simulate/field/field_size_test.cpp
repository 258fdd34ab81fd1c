#include "simulate/field/field_size.h"

#include <gtest/gtest.h>

#include "simulate/field/field_plan.h"
#include "simulate/field/integrators/integrator_choice.h"

namespace grainfield::simulate {

// The rest are statistics, transforms and copies: measured with them as 86 B a cell at the default.
TEST(FieldSize, IsMoreThanTheFieldsAloneAndFollowsTheirNumber) {
    FieldOptions options;
    options.lattice.nx = 256;
    const auto bytes = [&options] {
        RunPlan plan;
        const FieldPlan made = plan_field(options, plan);
        const auto fields = static_cast<double>(make_integrator(made.setup, 1)->memory());
        const double whole = size_of(options).bytes;
        EXPECT_GT(whole, fields);
        EXPECT_LT(whole, 7 * fields);
        return whole;
    };
    const double one = bytes();
    EXPECT_NEAR(one / (256 * 256), 86, 1);
    options.record.replicas = 4;
    EXPECT_NEAR((bytes() - one) / (256 * 256), 3 * 29, 1);
    options.scheme.precision = Precision::twofold;
    bytes();
}

// 1,000 steps of 512 × 512 take about 2 s on one thread.
TEST(FieldSize, ItsTimeIsThatOfItsSteps) {
    FieldOptions options;
    options.lattice.nx = 512;
    options.record = {.relax = 200, .record = 300};
    EXPECT_NEAR(size_of(options).seconds, 1.8, 0.9);
    options.lattice.nx = 1 << 24;
    EXPECT_GT(size_of(options).bytes, 1e16) << "counted as a real number";
}

}  // namespace grainfield::simulate
