#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/option_table.h"

namespace grainfield::app {

/// All options of one command, from the tables of its stages, under names that are unique.
///
/// On the command line an option is `--name`; where two sections share a name, it is
/// `--section-name` in both, and so is a name that looks like such a one. In a TOML file it is
/// `name` in `[section]`. Other names of an option are accepted in both places, as they stand.
/// Options of the empty section are command-wide: top-level keys, or keys of the section named like
/// the command.
class OptionSet {
 public:
    struct Entry {
        std::string section;
        std::string flag;  ///< without the dashes
        Option option;
    };

    /// `command`: all of its words, "simulate md"; its section in a file is the last one.
    OptionSet(std::string command, const std::vector<OptionTable>& tables);

    const std::string& command() const { return command_; }
    const std::vector<Entry>& entries() const { return entries_; }
    std::vector<std::string> flags() const;

    /// The text with each option as the command line has it: "--flag". Libraries name options
    /// "section.name", and a command-wide one "option 'name'".
    std::string with_flags(std::string text) const;

    bool has_section(std::string_view section) const;
    /// The sections a file may have, the command's own first.
    std::vector<std::string> sections() const;
    /// The keys of a section, other names of options included; the empty section stands for the
    /// top level.
    std::vector<std::string> keys(std::string_view section) const;
    const Entry* find(std::string_view section, std::string_view key) const;

    /// "section.name" (or "name" for command-wide options) → present value, in order; without those
    /// that concern one call only.
    std::vector<std::pair<std::string, std::string>> configuration() const;
    /// Names of those whose value changes how the outputs are made, or whether, and not what is in
    /// them.
    std::vector<std::string> indifferent() const;

 private:
    bool belongs(const Entry& entry, std::string_view section) const;
    static std::string recorded_name(const Entry& entry);
    void drop_taken_names();

    std::string command_;
    std::string own_section_;  ///< last word of the command
    std::vector<Entry> entries_;
};

}  // namespace grainfield::app
