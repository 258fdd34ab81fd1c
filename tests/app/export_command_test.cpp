#include "app/export_command.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::filesystem::path write_curve(const std::filesystem::path& path) {
    Results results;
    results.box = {{0, 0}, {1, 1}, {}, 0};
    ObservableResult sk;
    sk.name = "sk";
    sk.curves = {{"sk", "S", {{"k", "1/a", "k", {0.1, 0.2}}, {"s", "-", "S", {1, 2}}}, {}}};
    results.observables = {sk};
    io::write_results(path, results, Overwrite::force);
    return path;
}

void export_to(const std::filesystem::path& input, const std::string& output) {
    ExportCommand command;
    const std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(output));
    Session session;
    session.command = "export";
    session.inputs = {input};
    command.run(session);
}

TEST(ExportCommand, TakesANameWithANumberASlashOrThatIsThereForAFolder) {
    const testing::ScratchFolder folder;
    const auto input = write_curve(folder / "r.h5");
    std::filesystem::create_directory(folder / "there.csv");
    for (const char* name : {"e4.35", "gamma-4.35/", "new.csv/", "there.csv", "curves"}) {
        export_to(input, folder / name);
        EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(folder / name) / "sk.csv"))
            << name;
    }
}

TEST(ExportCommand, NeedsANameThatFitsTheFormatAskedFor) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "p.csv") << "frame,x,y\n0,1,2\n";
    const auto run = [&](const std::string& output, const std::string& format) {
        ExportCommand command;
        const std::vector<OptionTable> tables = command.options();
        tables.front().set("output", OptionValue(output));
        tables.front().set("format", OptionValue(format));
        Session session;
        session.command = "export";
        session.inputs = {std::filesystem::path(folder / "p.csv")};
        return command.run(session);
    };
    EXPECT_EQ(run("-", "xyz").text.substr(0, 2), "1\n");
    EXPECT_EQ(run("-", "auto").text.substr(0, 5), "frame");
    EXPECT_NO_THROW(run(folder / "a.xyz", "xyz"));
    EXPECT_THROW(run(folder / "b.csv", "xyz"), OptionError);
}

TEST(ExportCommand, NamesAFolderAfterResultsWithAPointInTheirName) {
    const testing::ScratchFolder folder;
    const ExportCommand command;
    EXPECT_EQ(command.default_output({write_curve(folder / "r.h5")}), "r-curves");
    EXPECT_EQ(command.default_output({write_curve(folder / "run.b.h5")}), "run.b-curves/");
    export_to(folder / "run.b.h5", folder / "run.b-curves/");
    EXPECT_TRUE(std::filesystem::exists(folder / "run.b-curves/sk.csv"));
}

TEST(ExportCommand, OfCurvesToTheNameOfAFileSaysHowToNameAFolder) {
    const testing::ScratchFolder folder;
    const auto input = write_curve(folder / "r.h5");
    for (const std::string& name : {folder / "sk.csv", folder / "curves.v2"}) {
        try {
            export_to(input, name);
            ADD_FAILURE() << name << " was written";
        } catch (const OptionError& error) {
            EXPECT_THAT(error.what(), AllOf(HasSubstr("the name of a folder"),
                                            HasSubstr("give -o " + name + "/")));
        }
        EXPECT_FALSE(std::filesystem::exists(name));
    }
}

}  // namespace
}  // namespace grainfield::app
