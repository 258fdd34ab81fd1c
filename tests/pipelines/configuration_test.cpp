#include "pipelines/configuration.h"

#include <gtest/gtest.h>

#include "simulate/field/field_options.h"
#include "simulate/md/md_options.h"

namespace grainfield::pipelines {
namespace {

TEST(Configuration, GiveEveryOptionThatTheResultDependsOnUnderItsSection) {
    int memory = 2;
    double fps = 25;
    bool strict = true;
    bool resume = true;
    double length = 10;
    OptionTable own("");
    own.number("fps", fps, "1/s", {}, "rate");
    own.flag("strict", strict, "strict");
    own.affects(Effect::work);
    own.flag("resume", resume, "go on");
    own.affects(Effect::call);
    own.number("length", length, "s", {}, "length");
    own.affects(Effect::extent);
    OptionTable link("link");
    link.integer("memory", memory, "frames", {}, "gaps bridged");
    memory = 3;
    EXPECT_EQ(physics_of({own, link}), (Configuration{{"fps", "25"}, {"link.memory", "3"}}));
}

TEST(Configuration, OfAFieldLetTheRecordingGrowInAResume) {
    simulate::FieldOptions a, b;
    b.record.record = 77;
    EXPECT_EQ(physics_of(simulate::describe(a)), physics_of(simulate::describe(b)));
    b.model.nu = 0.5;
    EXPECT_NE(physics_of(simulate::describe(a)), physics_of(simulate::describe(b)));
}

TEST(Configuration, OfMolecularDynamicsLetStripsAndLengthChangeInAResume) {
    simulate::MdOptions a, b;
    b.run.tiles = 7;
    b.run.periods += 1;
    EXPECT_EQ(physics_of(simulate::describe(a)), physics_of(simulate::describe(b)));
    b.run.discard += 1;
    EXPECT_NE(physics_of(simulate::describe(a)), physics_of(simulate::describe(b)));
}

TEST(Configuration, AreReplacedByThoseOfOneRunWhereTheyAreRecorded) {
    simulate::FieldOptions field;
    field.model.nu = 0.25;
    Configuration recorded{{"seed", "4"}, {"model.nu", "0.01"}, {"model.old", "1"}};
    update(recorded, simulate::describe(field));
    EXPECT_EQ(recorded, (Configuration{{"seed", "4"}, {"model.nu", "0.25"}, {"model.old", "1"}}));
}

}  // namespace
}  // namespace grainfield::pipelines
