#include "simulate/md/mechanics/sine.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {

TEST(Sine, AgreesWithTheLibraryToAnUlpOfOne) {
    RandomStream random(1, "sine");
    for (int i = 0; i < 1000000; ++i) {
        const double x = random.uniform(-400, 400);
        const SineCosine both = sine_cosine(x);
        ASSERT_NEAR(both.sine, std::sin(x), 2.3e-16) << x;
        ASSERT_NEAR(both.cosine, std::cos(x), 2.3e-16) << x;
    }
}

TEST(Sine, IsExactAtZero) {
    EXPECT_EQ(sine_cosine(0).sine, 0);
    EXPECT_EQ(sine_cosine(0).cosine, 1);
}

}  // namespace grainfield::simulate
