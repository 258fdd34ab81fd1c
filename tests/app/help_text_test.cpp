#include "app/help_text.h"

#include <algorithm>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/command_line.h"

namespace grainfield::app {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string output_of(std::string command, const std::string& last) {
    std::vector<std::string> words{"grainfield"};
    std::istringstream stream(command);
    for (std::string word; stream >> word;) words.push_back(word);
    words.push_back(last);
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStdout();
    EXPECT_EQ(run_command_line(static_cast<int>(argv.size()), argv.data()), 0) << command;
    return testing::internal::GetCapturedStdout();
}

std::size_t widest_line(const std::string& text) {
    std::size_t widest = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const auto columns = std::ranges::count_if(
            line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
        widest = std::max(widest, static_cast<std::size_t>(columns));
    }
    return widest;
}

// As it was before its lines were broken.
std::string in_one_line(const std::string& text) {
    return std::regex_replace(text, std::regex("\\s+"), " ");
}

TEST(HelpText, OfEveryCommandFitsAHundredColumns) {
    EXPECT_LE(widest_line(output_of("", "--help")), 100U);
    EXPECT_LE(widest_line(output_of("simulate", "--help")), 100U);
    for (const auto& command : make_commands()) {
        EXPECT_LE(widest_line(output_of(command->name(), "--help")), 100U) << command->name();
        EXPECT_LE(widest_line(output_of(command->name(), "--help-all")), 100U) << command->name();
    }
}

TEST(HelpText, InFullHasEveryOptionOfTheTablesWithItsMeaningUnitRangeAndDefault) {
    for (const auto& command : make_commands()) {
        const std::string help = in_one_line(output_of(command->name(), "--help-all"));
        const OptionSet options(command->name(), command->options());
        for (const OptionSet::Entry& entry : options.entries()) {
            const std::string domain = entry.option.domain_text();
            std::string words = entry.option.meaning;
            if (!domain.empty()) words += " (" + domain + ")";
            const auto at = help.find(
                "--" + entry.flag +
                (entry.option.kind == OptionKind::flag || !entry.option.other_names.empty() ? ""
                                                                                            : " "));
            ASSERT_NE(at, std::string::npos) << command->name() << " --" << entry.flag;
            EXPECT_THAT(help, HasSubstr(words)) << command->name() << " --" << entry.flag;
        }
    }
}

TEST(HelpText, ShowsTenOptionsAtFirstAndSaysHowToSeeTheRest) {
    for (const auto& command : make_commands()) {
        const std::string help = output_of(command->name(), "--help");
        std::size_t options = 0;
        std::istringstream lines(help);
        for (std::string line; std::getline(lines, line);) options += line.starts_with("  -");
        EXPECT_LE(options, 10U + 3U) << command->name() << ": besides help and configuration";
        const std::string rest = "grainfield " + command->name() + " --help-all";
        if (command->name() == "info") {
            EXPECT_THAT(help, Not(HasSubstr("more options"))) << "all of its options are there";
        } else {
            EXPECT_THAT(help, HasSubstr(rest));
        }
    }
    EXPECT_THAT(output_of("track", "--help"), Not(HasSubstr("--max-sweeps")));
    EXPECT_THAT(output_of("track", "--help"), HasSubstr("--disc-diameter"));
}

TEST(HelpText, OfAGroupNamesItsCommandsOnly) {
    const std::string help = output_of("simulate", "--help");
    EXPECT_THAT(help, HasSubstr("simulate md"));
    EXPECT_THAT(help, HasSubstr("simulate field"));
    EXPECT_THAT(help, Not(HasSubstr("analyze")));
}

TEST(HelpText, BreaksLinesBetweenWordsAndCountsSignsNotBytes) {
    EXPECT_EQ(wrapped("ab cd ef", 0, 2, 5), "ab cd\n  ef");
    EXPECT_EQ(wrapped("ωω ωω", 0, 1, 5), "ωω ωω") << "nine bytes, five columns";
    EXPECT_EQ(wrapped("unbreakable a", 0, 1, 4), "unbreakable\n a");
    EXPECT_EQ(wrapped("ab cd", 3, 4, 6), "ab\n    cd") << "the first line begins later";
}

}  // namespace
}  // namespace grainfield::app
