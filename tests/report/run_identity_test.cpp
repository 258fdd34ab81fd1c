#include "report/run_identity.h"

#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

Results md_run(const std::string& amplitude, const std::string& omega,
               const std::string& gravity = std::string("1")) {
    Results run;
    run.source.origin = Origin::md;
    RunRecord md;
    md.command = "simulate md";
    md.configuration = {{"vibration.amplitude", amplitude},
                        {"vibration.angular-frequency", omega},
                        {"cell.gravity", gravity}};
    run.sources = {md};
    return run;
}

TEST(RunIdentity, OfMolecularDynamicsHasGammaFromAmplitudeAndFrequency) {
    const RunIdentity identity = identity_of(md_run("0.09", "5"));
    EXPECT_EQ(identity.origin, "MD");
    EXPECT_EQ(identity.parameter, "Γ");
    EXPECT_DOUBLE_EQ(identity.value.value(), 2.25);
    EXPECT_EQ(legend_of(identity), "MD, Γ = 2.25");
}

TEST(RunIdentity, TakesGammaFromTheAnalysisBeforeTheSimulation) {
    Results run = md_run("0.09", "5");
    run.record.configuration = {{"gamma", "4.5"}};
    EXPECT_DOUBLE_EQ(identity_of(run).value.value(), 4.5);
    run.record.configuration = {{"gamma", "auto"}};
    EXPECT_DOUBLE_EQ(identity_of(run).value.value(), 2.25) << "auto is no number";
}

TEST(RunIdentity, OfAFieldHasNuDimensionAndB) {
    Results run;
    RunRecord field;
    field.command = "simulate field";
    field.configuration = {{"lattice.dimension", "1"}, {"model.b", "4"}, {"model.nu", "0.002"}};
    run.sources = {field};
    const RunIdentity identity = identity_of(run);
    EXPECT_EQ(legend_of(identity), "field, 1D, b = 4, ν = 0.002");
    EXPECT_EQ(identity.dimension, 1);
    EXPECT_TRUE(identity.is_field);
}

TEST(RunIdentity, OfAFilmWithoutGammaIsItsOriginAlone) {
    Results run;
    run.source.origin = Origin::video;
    EXPECT_EQ(legend_of(identity_of(run)), "tracked");
    run.source.origin = Origin::rendered;
    EXPECT_EQ(legend_of(identity_of(run)), "true positions");
    run.observables.emplace_back().name = "critical";
    EXPECT_EQ(identity_of(run).origin, "critical");
}

TEST(RunIdentity, WithoutGravityOrWithWordsForNumbersHasNoGamma) {
    EXPECT_FALSE(identity_of(md_run("0.09", "5", "0")).value.has_value());
    EXPECT_FALSE(identity_of(md_run("0.09", "fast")).value.has_value());
}

TEST(Origins, ComeInOrderOfAppearanceWithoutCriticalPoints) {
    const std::vector<RunIdentity> identities{
        {.origin = "MD"}, {.origin = "critical"}, {.origin = "tracked"}, {.origin = "MD"}};
    EXPECT_EQ(origins_of(identities), (std::vector<std::string>{"MD", "tracked"}));
}

}  // namespace
}  // namespace grainfield::report
