#include "tracking/model/profile_shape.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tracking/model/disc_profile.h"
#include "tracking/model/kernel_profile.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

/// The tanh edge again, with no more than a shape must state.
class PlainTanh final : public ProfileShape {
 public:
    std::string_view name() const override { return "plain tanh"; }
    double darkness(double r, double diameter, double edge_width) const override {
        return kTanhEdge.darkness(r, diameter, edge_width);
    }
};
const PlainTanh kPlain;

TEST(ProfileShape, NumericalDefaultsAreTheDerivatives) {
    const DiscProfile exact{16, 1.2};
    const DiscProfile plain{16, 1.2, &kPlain};
    for (const double r : {3.0, 6.5, 7.9, 8.0, 9.3, 11.0}) {
        EXPECT_NEAR(plain.slope(r), exact.slope(r), 1e-6);
        const SizeDerivatives a = plain.size_derivatives(r, 0.7);
        const SizeDerivatives b = exact.size_derivatives(r, 0.7);
        EXPECT_NEAR(a.by_diameter, b.by_diameter, 1e-6);
        EXPECT_NEAR(a.by_edge_width, b.by_edge_width, 1e-6);
    }
    EXPECT_NEAR(plain.information() / exact.information(), 1, 1e-4);
    EXPECT_EQ(plain.reach(), exact.reach());
    EXPECT_EQ(plain.core_radius(), exact.core_radius());
}

// 2e-5 between the values of the table, and 9e-4 where t is held above zero.
TEST(ProfileShape, KernelsReadFromTheTableWhatTheyCompute) {
    for (const double width : {0.4, 1.2, 6.0}) {
        const DiscProfile exact{16, width};
        const DiscProfile plain{16, width, &kPlain};
        PaddedImage a = clear_transmission(70, 70, exact);
        PaddedImage b = clear_transmission(70, 70, plain);
        place_discs(a, {{34.3, 33.8}, {42.1, 40.2}}, exact);
        place_discs(b, {{34.3, 33.8}, {42.1, 40.2}}, plain);
        for (int y = 0; y < 70; ++y) {
            for (int x = 0; x < 70; ++x) EXPECT_NEAR(a(x, y), b(x, y), 5e-5) << x << ' ' << y;
        }
        const KernelProfile computed(exact);
        const KernelProfile table(plain);
        EXPECT_FALSE(computed.is_tabulated());
        EXPECT_TRUE(table.is_tabulated());
        for (float r = 0; r < 30; r += 0.37F) {
            EXPECT_NEAR(table.darkness(r), computed.darkness(r), 1.1e-3F) << r;
        }
    }
}

}  // namespace
}  // namespace grainfield::tracking
