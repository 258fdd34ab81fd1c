#pragma once

#include <string>
#include <vector>

#include "app/command.h"
#include "app/option_set.h"

namespace grainfield::app {

/// One option as help, manual page and completion show it.
struct OptionPage {
    std::vector<std::string> names;  ///< "-o", "--output"; of a flag that is on, "--no-…" last
    std::string value;               ///< what stands for its value, "FILE"; empty for flags
    std::string meaning;
    std::string domain;                ///< "[px] 3 … 400, default auto"
    std::string section;               ///< of a TOML file; empty: command-wide
    std::vector<std::string> choices;  ///< "auto" included where it is one
    bool may_be_file = false;          ///< its value is text, which may name a file
    bool is_usual = false;             ///< shown by --help
};

/// A command as help, manual page and completion show it.
struct CommandPage {
    std::string name;  ///< "simulate md"
    std::string purpose;
    Command::Inputs inputs;
    std::vector<OptionPage> options;  ///< --help, --help-all and --config first

    /// What follows the name of the program: "track [OPTIONS] VIDEO|IMAGE...".
    std::string usage() const;
};

/// The program with all of its commands.
struct ProgramPage {
    std::string about;                  ///< one sentence
    std::vector<OptionPage> options;    ///< of the program itself
    std::vector<CommandPage> commands;  ///< in the order of the help text
    std::string missing;                ///< libraries that this build is without

    const CommandPage* find(const std::string& name) const;
};

/// How the option is written on the command line, short forms included: "-o", "--output".
std::vector<std::string> names_of(const OptionSet::Entry& entry);

/// What stands for the value of the option: "X" for a number, "N" for an integer, "TEXT", "NAME".
std::string value_name(const Option& option);

/// The page of a command whose options are `options`. Throws std::logic_error if
/// `Command::usual()` names an option that there is not.
CommandPage page_of(const Command& command, const OptionSet& options);

}  // namespace grainfield::app
