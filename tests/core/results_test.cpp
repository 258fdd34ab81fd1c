#include "core/results.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(Results, AreFoundByNameDownToTheColumn) {
    Curve curve{"sk", "structure factor", {{"k", "1/a", "wavevector", {1, 2}}}, {}};
    ObservableResult sk;
    sk.name = "sk";
    sk.curves.push_back(curve);
    sk.measurements.push_back({"s0", "-", 0.05, 0.01, 30, ""});
    sk.options.emplace_back("shell-width", 0.25);
    Results results;
    results.observables.push_back(sk);

    const ObservableResult* found = results.find("sk");
    ASSERT_NE(found, nullptr);
    ASSERT_NE(found->find_curve("sk"), nullptr);
    ASSERT_NE(found->find_curve("sk")->find("k"), nullptr);
    EXPECT_EQ(found->find_curve("sk")->find("k")->values.size(), 2U);
    ASSERT_NE(found->find_measurement("s0"), nullptr);
    EXPECT_EQ(found->find_measurement("s0")->value, 0.05);
    ASSERT_NE(found->find_option("shell-width"), nullptr);
    EXPECT_EQ(*found->find_option("shell-width"), OptionValue(0.25));
}

TEST(Results, WhatIsNotThereIsNull) {
    const Results results;
    const ObservableResult observable;
    const Curve curve;
    EXPECT_EQ(results.find("sk"), nullptr);
    EXPECT_EQ(observable.find_curve("sk"), nullptr);
    EXPECT_EQ(observable.find_measurement("s0"), nullptr);
    EXPECT_EQ(observable.find_option("shell-width"), nullptr);
    EXPECT_EQ(curve.find("k"), nullptr);
}

}  // namespace
}  // namespace grainfield
