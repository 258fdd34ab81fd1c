#include "tracking/repeated_warnings.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

std::vector<std::string> said(const RepeatedWarnings& warnings) {
    RunPlan plan;
    warnings.say("a.mp4", plan);
    std::vector<std::string> texts;
    for (const Warning& warning : plan.warnings()) texts.push_back(warning.text);
    return texts;
}

TEST(RepeatedWarnings, SaysOnceWhatIsTrueOfManyFrames) {
    RepeatedWarnings warnings;
    for (int frame = 3; frame < 45; ++frame) {
        warnings.add(frame, "no contrast: " + std::to_string(frame) + ".5 counts");
    }
    warnings.add(7, "no spheres found");
    EXPECT_EQ(said(warnings),
              (std::vector<std::string>{"a.mp4, 42 frames from 3 to 44: no contrast: 3.5 counts",
                                        "a.mp4, frame 7: no spheres found"}));
}

TEST(RepeatedWarnings, GoOnCountingWhereAnInterruptedRunStopped) {
    RepeatedWarnings before;
    before.add(1, "dark");
    before.add(2, "dark");
    Checkpoint saved;
    before.save(saved);
    RepeatedWarnings after;
    after.restore(saved);
    after.add(3, "dark");
    EXPECT_EQ(said(after), std::vector<std::string>{"a.mp4, 3 frames from 1 to 3: dark"});
}

TEST(RepeatedWarnings, RefuseADamagedCheckpoint) {
    Checkpoint saved;
    saved.texts["repeated warnings"] = {"dark"};
    RepeatedWarnings warnings;
    EXPECT_THROW(warnings.restore(saved), InputError);
}

}  // namespace
}  // namespace grainfield::tracking
