#include "app/info_command.h"

#include <gtest/gtest.h>

#include "core/results.h"
#include "io/h5/results_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

TEST(InfoCommand, ShowsACriticalPointThatHasNeitherPointsNorValues) {
    const testing::ScratchFolder folder;
    Results results;
    results.box = {{0, 0}, {1, 1}, {}, 0};
    ObservableResult critical;
    critical.name = "critical";
    critical.measurements = {{"power", "-", std::nullopt, std::nullopt, 0, "no points"},
                             {"critical_value", "-", std::nullopt, std::nullopt, 0, "no points"}};
    critical.curves = {{"critical", "S0/S1", {}, {}}};
    results.observables = {critical};
    io::write_results(folder / "critical.h5", results, Overwrite::force);
    InfoCommand info;
    info.options();
    Session session;
    session.inputs = {folder / "critical.h5"};
    const Summary summary = info.run(session);
    EXPECT_EQ(summary.facts["runs"], 0);
    EXPECT_FALSE(summary.facts.contains("power"));
    EXPECT_FALSE(summary.facts.contains("critical_value"));
}

}  // namespace
}  // namespace grainfield::app
