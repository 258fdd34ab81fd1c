#include "report/figures/gnuplot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

TEST(Gnuplot, ThatIsNotInstalledIsNoError) {
    const sample::TemporaryFolder folder("gnuplot_absent");
    const auto outcome = Gnuplot("grainfield-no-such-program").run("plot x", folder.path());
    EXPECT_FALSE(outcome.started);
    EXPECT_FALSE(outcome.succeeded);
    EXPECT_THAT(outcome.message, testing::HasSubstr("No such file"));
}

TEST(Gnuplot, TellsWhatWentWrong) {
    const sample::TemporaryFolder folder("gnuplot_fails");
    const auto outcome = Gnuplot().run("no such command\n", folder.path());
    if (!outcome.started) GTEST_SKIP() << "gnuplot is not installed";
    EXPECT_FALSE(outcome.succeeded);
    EXPECT_THAT(outcome.message, testing::HasSubstr("invalid command"));
}

TEST(Gnuplot, ReadsALongScriptAndWorksInTheFolder) {
    const sample::TemporaryFolder folder("gnuplot_long");
    std::string script(1 << 20, '\n');  // longer than any pipe
    script += "set print 'out.txt'\nprint 6*7\n";
    const auto outcome = Gnuplot().run(script, folder.path());
    if (!outcome.started) GTEST_SKIP() << "gnuplot is not installed";
    EXPECT_TRUE(outcome.succeeded) << outcome.message;
    EXPECT_TRUE(std::filesystem::exists(folder / "out.txt"));
}

}  // namespace
}  // namespace grainfield::report
