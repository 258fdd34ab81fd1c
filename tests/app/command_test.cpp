#include "app/command.h"

#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "app/analyze_command.h"
#include "app/option_set.h"
#include "core/errors.h"
#include "core/version.h"

namespace grainfield::app {
namespace {

Session session() {
    Session s;
    s.command = "track";
    s.threads = 3;
    s.seed = 42;
    s.configuration = {{"fps", "auto"}, {"link.memory", "3"}};
    s.plan.run("detect", "always");
    s.plan.skip("link", "one frame", "identities");
    s.plan.warn("frame 2 is dark");
    s.outputs = {"tracks.h5"};
    return s;
}

TEST(Outputs, AreNamedAfterTheFirstInputWithoutWhatACommandBeforeHasAdded) {
    EXPECT_EQ(named_after({"films/layer.avi"}, "-tracks.h5"), "layer-tracks.h5");
    EXPECT_EQ(named_after({"layer-tracks.h5"}, "-results.h5"), "layer-results.h5");
    EXPECT_EQ(named_after({"layer-results.h5", "md-results.h5"}, "-report.html"),
              "layer-report.html");
    EXPECT_EQ(named_after({}, "-report.html"), "report.html");
}

TEST(Outputs, OfPagesAndFoldersHaveNoOtherEnding) {
    EXPECT_NO_THROW(require_html_name("a.html"));
    for (const char* wrong : {"a.pdf", "a", "-"}) {
        EXPECT_THROW(require_html_name(wrong), OptionError) << wrong;
    }
    EXPECT_NO_THROW(require_folder_name("run.7", "a folder"));
    EXPECT_NO_THROW(require_folder_name("results", "a folder"));
    for (const char* wrong : {"a.csv", "a.html", "-"}) {
        EXPECT_THROW(require_folder_name(wrong, "a folder"), OptionError) << wrong;
    }
}

TEST(Outputs, ThatAreNoTextSayWhatCanGoToStandardOutputInstead) {
    const auto said = [](const auto& require) -> std::string {
        try {
            require();
        } catch (const OptionError& error) {
            return error.what();
        }
        return {};
    };
    for (const std::string& words :
         {said([] { require_html_name("-"); }), said([] { require_hdf5_name("-"); }),
          said([] { require_folder_name("-", "a folder"); })}) {
        EXPECT_NE(words.find("cannot go to standard output"), std::string::npos) << words;
        EXPECT_NE(words.find("compare --figure"), std::string::npos) << words;
    }
    EXPECT_NE(said([] { require_hdf5_name("-"); }).find("export NAME.h5 -o -"), std::string::npos);
}

TEST(Outputs, MeansThatAreWholeHaveNoPoint) {
    EXPECT_EQ(mean_text(10240), "10240");
    EXPECT_EQ(mean_text(319.62), "319.6");
}

TEST(Outputs, EveryCommandThatWritesNamesOne) {
    for (const auto& command : make_commands()) {
        const OptionSet options(command->name(), command->options());
        const OptionSet::Entry* output = options.find("", "output");
        // A run names its folder itself; what is exported depends on the content of the file.
        if (output == nullptr || command->name() == "run" || command->name() == "export") continue;
        EXPECT_NE(command->default_output({"layer.avi"}), "") << command->name();
    }
}

TEST(JsonSummary, HoldsTheKeysThatScriptsRelyOn) {
    Summary summary;
    summary.facts["frames"] = 7;
    const auto object = json_summary(session(), summary);
    EXPECT_EQ(object["command"], "track");
    EXPECT_EQ(object["version"], kVersion);
    EXPECT_EQ(object["seed"], 42);
    EXPECT_EQ(object["threads"], 3);
    EXPECT_GE(object["seconds"].get<double>(), 0);
    ASSERT_EQ(object["skipped"].size(), 1U);
    EXPECT_EQ(object["skipped"][0]["stage"], "link");
    EXPECT_EQ(object["skipped"][0]["reason"], "one frame");
    EXPECT_EQ(object["skipped"][0]["saved"], "identities");
    EXPECT_EQ(object["warnings"], nlohmann::ordered_json{"frame 2 is dark"});
    EXPECT_EQ(object["outputs"], nlohmann::ordered_json{"tracks.h5"});
    EXPECT_EQ(object["frames"], 7);
}

TEST(SessionRecord, RepeatsWhatWasAskedForAndWhatWasSkipped) {
    const RunRecord record = session().record();
    EXPECT_EQ(record.command, "track");
    EXPECT_EQ(record.version, kVersion);
    EXPECT_EQ(record.seed, 42U);
    EXPECT_EQ(record.threads, 3);
    EXPECT_EQ(record.configuration.at(1).first, "link.memory");
    EXPECT_EQ(record.skipped, std::vector<std::string>{"link: one frame"});
    EXPECT_EQ(record.warnings, std::vector<Warning>{{.text = "frame 2 is dark"}});
}

TEST(Explanation, GivesThePlanInWordsAndAsJson) {
    const Summary summary = explanation(session().plan);
    EXPECT_EQ(summary.text, session().plan.text());
    ASSERT_EQ(summary.facts["plan"].size(), 2U);
    EXPECT_EQ(summary.facts["plan"][0]["runs"], true);
    EXPECT_EQ(summary.facts["plan"][1]["runs"], false);
}

TEST(RequireOutput, RefusesNoneAndAnInput) {
    const auto file = std::filesystem::path(testing::TempDir()) / "grainfield-command-test.h5";
    std::ofstream(file) << "x";
    Session s = session();
    s.inputs = {file};
    EXPECT_THROW(require_output(s, ""), OptionError);
    EXPECT_THROW(require_output(s, file.string()), OptionError);
    EXPECT_THROW(require_output(s, (file.parent_path() / "." / file.filename()).string()),
                 OptionError);
    EXPECT_NO_THROW(require_output(s, "elsewhere.h5"));
    std::filesystem::remove(file);
}

TEST(Commands, HaveOneLinePurposesAndUniqueFlags) {
    std::vector<std::string> names;
    for (const auto& command : make_commands()) {
        names.push_back(command->name());
        EXPECT_FALSE(command->purpose().empty());
        EXPECT_EQ(command->purpose().find('\n'), std::string::npos);
        CommonOptions common;
        std::vector<OptionTable> tables = command->options();
        tables.push_back(describe(common));
        const auto flags = OptionSet(command->name(), tables).flags();
        EXPECT_EQ(std::set<std::string>(flags.begin(), flags.end()).size(), flags.size());
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"run", "track", "link", "tune", "calibrate-camera",
                                        "simulate md", "simulate field", "render", "analyze",
                                        "critical", "compare", "validate", "export", "info"}));
}

TEST(AnalyzeCommand, NamesAPartAfterItsTracksWithTheEndingOfAccumulators) {
    AnalyzeCommand analyze;
    const std::vector<OptionTable> tables = analyze.options();
    EXPECT_EQ(analyze.default_output({"a/part-0-tracks.h5"}), "part-0-results.h5");
    tables.front().set("partial", OptionValue(true));
    EXPECT_EQ(analyze.default_output({"a/part-0-tracks.h5"}), "part-0.acc");
}

}  // namespace
}  // namespace grainfield::app
