#include "app/command_page.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace grainfield::app {

namespace {

constexpr std::size_t usual_options = 10;

const char* element_name(OptionKind kind) {
    switch (kind) {
        case OptionKind::flag:
            return "";
        case OptionKind::integer:
            return "N";
        case OptionKind::number:
            return "X";
        case OptionKind::text:
            return "TEXT";
        case OptionKind::choice:
            return "NAME";
    }
    return "";
}

bool is_negatable(const OptionSet::Entry& entry) {
    return entry.option.kind == OptionKind::flag &&
           (entry.option.default_value == OptionValue(true) || entry.option.may_be_auto);
}

std::vector<OptionPage> options_of_the_parser() {
    OptionPage help{.names = {"-h", "--help"},
                    .value = {},
                    .meaning = "print the usual options, then stop",
                    .domain = {},
                    .section = {},
                    .choices = {},
                    .is_usual = true};
    OptionPage all = help;
    all.names = {"--help-all"};
    all.meaning = "print all options, then stop";
    OptionPage config = help;
    config.names = {"-c", "--config"};
    config.value = "FILE";
    config.meaning = "read options from this TOML file; the command line wins";
    config.may_be_file = true;
    return {help, all, config};
}

std::vector<std::string> usual_of(const Command& command, const OptionSet& options) {
    std::vector<std::string> usual = command.usual();
    if (!usual.empty()) return usual;
    for (const OptionSet::Entry& entry : options.entries()) {
        if (usual.size() < usual_options) usual.push_back(entry.flag);
    }
    return usual;
}

}  // namespace

std::vector<std::string> names_of(const OptionSet::Entry& entry) {
    std::vector<std::string> names;
    if (entry.flag == "output") names.emplace_back("-o");
    if (entry.flag == "verbose") names.emplace_back("-v");
    names.push_back("--" + entry.flag);
    for (const std::string& other : entry.option.other_names) names.push_back("--" + other);
    if (is_negatable(entry)) names.push_back("--no-" + entry.flag);
    return names;
}

std::string value_name(const Option& option) {
    const std::string name = element_name(option.kind);
    return option.is_list ? fmt::format("{0},{0},…", name) : name;
}

std::string CommandPage::usage() const {
    std::string text = name + " [OPTIONS]";
    if (inputs.count == Command::Count::none) return text;
    const bool is_optional = inputs.count == Command::Count::any;
    return fmt::format("{} {}{}{}", text, is_optional ? "[" : "", inputs.placeholder,
                       is_optional ? "]" : "");
}

const CommandPage* ProgramPage::find(const std::string& name) const {
    const auto found = std::ranges::find(commands, name, &CommandPage::name);
    return found == commands.end() ? nullptr : &*found;
}

CommandPage page_of(const Command& command, const OptionSet& options) {
    CommandPage page{.name = command.name(),
                     .purpose = command.purpose(),
                     .inputs = command.inputs(),
                     .options = options_of_the_parser()};
    std::vector<std::string> usual = usual_of(command, options);
    for (const OptionSet::Entry& entry : options.entries()) {
        const Option& option = entry.option;
        OptionPage shown{.names = names_of(entry),
                         .value = value_name(option),
                         .meaning = option.meaning,
                         .domain = option.domain_text(),
                         .section = entry.section,
                         .choices = option.choices};
        if (option.kind == OptionKind::choice && option.may_be_auto) {
            shown.choices.emplace_back(automatic);
        }
        shown.may_be_file = option.kind == OptionKind::text && !option.is_list;
        shown.is_usual = std::erase(usual, entry.flag) > 0;
        page.options.push_back(std::move(shown));
    }
    if (!usual.empty()) {
        throw std::logic_error(fmt::format("'{}' has no option --{}", page.name, usual.front()));
    }
    return page;
}

}  // namespace grainfield::app
