#include "pipelines/recorded_options.h"

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

TEST(RecordedOptions, GiveEveryOptionUnderItsSectionButThoseLeftOut) {
    int memory = 2;
    double fps = 25;
    bool strict = true;
    OptionTable own("");
    own.number("fps", fps, "1/s", {}, "rate");
    own.flag("strict", strict, "strict");
    OptionTable link("link");
    link.integer("memory", memory, "frames", {}, "gaps bridged");
    memory = 3;
    EXPECT_EQ(recorded_options({own, link}, {"strict"}),
              (Configuration{{"fps", "25"}, {"link.memory", "3"}}));
}

}  // namespace
}  // namespace grainfield::pipelines
