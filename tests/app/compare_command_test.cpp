#include "app/compare_command.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Results with S(k) and its fit; without errors if asked.
std::filesystem::path write_run(const std::filesystem::path& path, const std::string& label,
                                bool has_errors = true, const std::string& version = "0.1.0",
                                Origin origin = Origin::points) {
    Results run;
    run.label = label;
    run.source.origin = run.identity.origin = origin;
    run.box = {{0, 0}, {10, 10}, {}, 0};
    run.record.command = "analyze";
    run.record.version = version;
    ObservableResult sk;
    sk.name = "sk";
    Curve curve{
        "sk", "S", {{"k", "1/a", "k", {}}, {"s", "-", "S", {}}, {"s_err", "-", "e", {}}}, {}};
    for (int i = 1; i <= 50; ++i) {
        curve.columns[0].values.push_back(0.1 * i);
        curve.columns[1].values.push_back(0.2 + 0.1 * i);
        curve.columns[2].values.push_back(has_errors ? 0.01 : std::nan(""));
    }
    sk.curves = {curve};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s0", "-", 0.2, std::nullopt, 10, has_errors ? "" : "too few frames"},
                        {"s1", "-", 1.0, std::nullopt, 10, "no error"}};
    if (has_errors) fit.measurements[0].error = 0.01;
    run.observables = {sk, fit};
    io::write_results(path, run, Overwrite::force);
    return path;
}

struct Compared {
    Summary summary;
    std::vector<std::string> warnings;
    std::string page;
};

Compared compare(const testing::ScratchFolder& folder, std::vector<std::filesystem::path> inputs,
                 bool figures = false) {
    CompareCommand command;
    std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(folder / "report.html"));
    tables.front().set("figures", OptionValue(figures));
    Session session;
    session.command = "compare";
    session.overwrite = Overwrite::force;
    session.inputs = std::move(inputs);
    Compared out;
    out.summary = command.run(session);
    for (const Warning& warning : session.plan.warnings()) out.warnings.push_back(warning.text);
    std::stringstream text;
    text << std::ifstream(folder / "report.html").rdbuf();
    out.page = text.str();
    return out;
}

void cut(const std::filesystem::path& path) {
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
}

TEST(CompareCommand, LeavesOutWhatCannotBeReadNamesItAndComparesTheRest) {
    const testing::ScratchFolder folder;
    const auto good = write_run(folder / "good.h5", "good");
    const auto short_file = write_run(folder / "short.h5", "short");
    cut(short_file);
    const auto other = write_run(folder / "other.h5", "other");
    std::ofstream(folder / "text.h5") << "no results";
    const Compared out = compare(folder, {good, short_file, folder / "text.h5", other});
    EXPECT_EQ(out.summary.facts["labels"].size(), 2U);
    EXPECT_EQ(out.summary.facts["left_out"], 2);
    for (const char* name : {"short.h5", "text.h5"}) {
        EXPECT_THAT(out.warnings, Contains(HasSubstr(name)));
        EXPECT_THAT(out.page, HasSubstr(name)) << "the page says it too";
    }
    EXPECT_THAT(out.page, HasSubstr("2 runs side by side"));
}

TEST(CompareCommand, RefusesAFileThatIsNotThereBesideAGoodOne) {
    const testing::ScratchFolder folder;
    const auto good = write_run(folder / "good.h5", "good");
    try {
        compare(folder, {good, folder / "absent.h5"});
        FAIL() << "no exception";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("absent.h5"));
        EXPECT_THAT(error.what(), HasSubstr("no such file"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "report.html"));
}

TEST(CompareCommand, OfNothingReadableIsAnErrorThatNamesTheFirst) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "text.h5") << "no results";
    try {
        compare(folder, {folder / "text.h5"});
        FAIL() << "no exception";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("text.h5"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "report.html"));
}

TEST(CompareCommand, OfNothingReadableWarnsOnlyOfTheFilesAfterTheFirst) {
    const testing::ScratchFolder folder;
    CompareCommand command;
    const std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(folder / "report.html"));
    Session session;
    session.command = "compare";
    session.inputs = {std::filesystem::path(folder / "first.h5"),
                      std::filesystem::path(folder / "second.h5")};
    for (const auto& input : session.inputs) std::ofstream(input) << "no results";
    EXPECT_THROW(command.run(session), InputError);
    ASSERT_EQ(session.plan.warnings().size(), 1U);
    EXPECT_THAT(session.plan.warnings()[0].text, HasSubstr("second.h5"));
}

TEST(CompareCommand, SaysWhichRunsHaveNoErrorsAndWhichAnotherVersion) {
    const testing::ScratchFolder folder;
    const Compared out = compare(
        folder, {write_run(folder / "a.h5", "first"), write_run(folder / "b.h5", "bare", false),
                 write_run(folder / "c.h5", "old", true, "0.0.9")});
    EXPECT_THAT(out.warnings, Contains(HasSubstr("cannot be judged: bare")));
    EXPECT_THAT(out.warnings, Contains(HasSubstr("0.0.9 (old), 0.1.0 (first and 1 more)")));
    EXPECT_EQ(out.page.find("figure-q4_histogram"), std::string::npos)
        << "no panel for what none of them has";
}

TEST(CompareCommand, DrawsOneFigureForPrintAndNamesThoseThatThereAre) {
    const testing::ScratchFolder folder;
    const auto run = write_run(folder / "a.h5", "first", true, "0.1.0", Origin::video);
    const auto draw = [&](const std::string& name, const std::string& file, bool paper = false) {
        CompareCommand command;
        const std::vector<OptionTable> tables = command.options();
        tables.front().set("output", OptionValue(folder / file));
        tables.front().set("figure", OptionValue(name));
        tables.front().set("paper", OptionValue(paper));
        Session session;
        session.inputs = {run};
        command.run(session);
        std::stringstream text;
        text << std::ifstream(folder / file).rdbuf();
        return text.str();
    };
    try {
        EXPECT_TRUE(draw("s-over-s1", "a.pdf").starts_with("%PDF"));
        EXPECT_THAT(draw("s-over-s1", "a.svg"), HasSubstr("<svg"));
        EXPECT_TRUE(draw("sk", "a.png").starts_with("\x89PNG"));
    } catch (const OutputError& error) {
        GTEST_SKIP() << error.what();  // no gnuplot
    }
    EXPECT_THROW(draw("sk", "a.txt"), OptionError);
    EXPECT_THAT(draw("paper-2a", "paper.svg", true), HasSubstr("<svg"));
    try {
        draw("paper-2a", "c.svg");
        ADD_FAILURE() << "drawn without 'paper'";
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), HasSubstr("add option 'paper'"));
    }
    try {
        draw("paper-3", "c.svg", true);
        ADD_FAILURE() << "drawn without data";
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), HasSubstr("one of sk, sk_scaled, paper_2a"));
    }
    try {
        draw("msd", "b.pdf");
        ADD_FAILURE() << "drawn without data";
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), HasSubstr("one of sk, sk_scaled"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "b.pdf"));
}

TEST(CompareCommand, SaysWhichRunAFigureShowsNothingOfAndWhy) {
    const testing::ScratchFolder folder;
    const auto write_moving = [&](const char* name, TimeUnit unit) {
        Results run;
        run.label = name;
        run.box = {{0, 0}, {10, 10}, {}, 0};
        run.record.command = "analyze";
        run.source.time_unit = unit;
        Curve msd{"msd",
                  "MSD",
                  {{"t", "time unit", "Lag", {1, 2, 3}},
                   {"msd", "a^2", "MSD", {1, 2, 3}},
                   {"msd_err", "a^2", "error", {0.1, 0.1, 0.1}}},
                  {}};
        run.observables.emplace_back().name = "msd";
        run.observables.back().curves = {msd};
        io::write_results(folder / name, run, Overwrite::force);
        return std::filesystem::path(folder / name);
    };
    CompareCommand command;
    const std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(folder / "msd.svg"));
    tables.front().set("figure", OptionValue(std::string("msd")));
    Session session;
    session.inputs = {write_moving("film", TimeUnit::frame),
                      write_moving("md", TimeUnit::sqrt_a_over_g)};
    try {
        command.run(session);
    } catch (const OutputError& error) {
        GTEST_SKIP() << error.what();  // no gnuplot
    }
    std::string said;
    for (const Warning& warning : session.plan.warnings()) said += warning.text + "\n";
    EXPECT_THAT(said, HasSubstr("the figure 'msd' shows nothing of 'md'"));
    EXPECT_THAT(said, HasSubstr("--fps"));
    EXPECT_THAT(said, HasSubstr("--sphere-mm"));
}

TEST(CompareCommand, PrintsAFigureAsSvgAndNothingElse) {
    const testing::ScratchFolder folder;
    const auto run = write_run(folder / "a.h5", "first");
    const auto print = [&](const std::string& figure, bool json) {
        CompareCommand command;
        const std::vector<OptionTable> tables = command.options();
        tables.front().set("output", OptionValue(std::string("-")));
        tables.front().set("figure", OptionValue(figure));
        Session session;
        session.inputs = {run};
        session.common.json = json;
        Summary summary = command.run(session);
        EXPECT_TRUE(session.outputs.empty());
        return summary;
    };
    EXPECT_THROW(print("", false), OptionError) << "a page";
    EXPECT_THROW(print("sk", true), OptionError) << "two outputs on one stream";
    EXPECT_THROW(print("msd", false), OptionError) << "no such figure";
    try {
        const Summary summary = print("sk", false);
        EXPECT_TRUE(summary.is_table);
        EXPECT_TRUE(summary.text.starts_with("<?xml")) << summary.text.substr(0, 40);
        EXPECT_TRUE(summary.text.ends_with("</svg>\n\n") || summary.text.ends_with("</svg>\n"));
    } catch (const OutputError& error) {
        GTEST_SKIP() << error.what();  // no gnuplot
    }
    EXPECT_EQ(folder.entries(), 1U) << "the input";
}

TEST(CompareCommand, OfTwoHundredRunsNamesEachOfThem) {
    const testing::ScratchFolder folder;
    std::vector<std::filesystem::path> inputs;
    for (int i = 0; i < 200; ++i) {
        const std::string name = "run " + std::to_string(i);
        inputs.push_back(write_run(folder / (name + ".h5"), name));
    }
    const auto start = std::chrono::steady_clock::now();
    const Compared out = compare(folder, inputs, true);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(out.summary.facts["labels"].size(), 200U);
    EXPECT_THAT(out.page, HasSubstr("run 199"));
    EXPECT_LT(out.page.size(), 15'000'000U);
    EXPECT_LT(time.count(), 120) << "seconds, on a loaded machine; 5 are meant for 20 runs";
}

TEST(CompareCommand, KeepsMarkupInNamesAsText) {
    const testing::ScratchFolder folder;
    const Compared out = compare(folder, {write_run(folder / "a<b>.h5", "<b>bold</b> & \"quoted\""),
                                          write_run(folder / "c.h5", "plain")});
    EXPECT_THAT(out.page, HasSubstr("&lt;b&gt;bold&lt;/b&gt; &amp;"));
    EXPECT_THAT(out.page, Not(HasSubstr("<b>bold")));
}

}  // namespace
}  // namespace grainfield::app
