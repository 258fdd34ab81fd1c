#include "app/help_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace grainfield::app {

namespace {

constexpr std::size_t margin = 2;    // before a name [columns]
constexpr std::size_t meaning = 28;  // where meanings begin [columns]

std::size_t columns(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) {
        return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // no continuation byte of UTF-8
    }));
}

// A name and its meaning beside it, or below it where the name is long.
std::string entry(const std::string& name, const std::string& words) {
    std::string text = std::string(margin, ' ') + name;
    std::size_t at = margin + columns(name);
    if (at + 2 > meaning) {
        text += '\n';
        at = 0;
    }
    text.append(meaning - at, ' ');
    return text + wrapped(words, meaning, meaning, help_width) + '\n';
}

std::string joined(const std::vector<std::string>& names, std::string_view between) {
    std::string text;
    for (const std::string& name : names) {
        if (!text.empty()) text += between;
        text += name;
    }
    return text;
}

std::string entry(const OptionPage& option) {
    std::string name = joined(option.names, ", ");
    if (!option.value.empty()) name += " " + option.value;
    std::string words = option.meaning;
    if (!option.domain.empty()) words += " (" + option.domain + ")";
    return entry(name, words);
}

std::string options_of_section(const CommandPage& page, const std::string& section) {
    std::string text =
        section.empty() ? "\nOptions:\n" : fmt::format("\nOptions of [{}]:\n", section);
    for (const OptionPage& option : page.options) {
        if (option.section == section) text += entry(option);
    }
    return text;
}

std::string all_options(const CommandPage& page) {
    std::vector<std::string> sections;
    for (const OptionPage& option : page.options) {
        if (std::ranges::find(sections, option.section) == sections.end()) {
            sections.push_back(option.section);
        }
    }
    std::string text;
    for (const std::string& section : sections) text += options_of_section(page, section);
    return text;
}

std::string usual_options(const CommandPage& page) {
    std::string text = "\nUsual options:\n";
    for (const OptionPage& option : page.options) {
        if (option.is_usual) text += entry(option);
    }
    const auto left = std::ranges::count(page.options, false, &OptionPage::is_usual);
    return text + fmt::format("\n{} more options: grainfield {} --help-all\n", left, page.name);
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t first, std::size_t indent,
                    std::size_t width) {
    std::string lines;
    std::size_t at = first;
    bool is_begin = true;
    while (true) {
        text.remove_prefix(std::min(text.size(), text.find_first_not_of(' ')));
        if (text.empty()) return lines;
        const std::string_view word = text.substr(0, text.find(' '));
        text.remove_prefix(word.size());
        if (!is_begin && at + 1 + columns(word) > width) {
            lines += '\n' + std::string(indent, ' ');
            at = indent;
            is_begin = true;
        }
        if (!is_begin) {
            lines += ' ';
            ++at;
        }
        lines += word;
        at += columns(word);
        is_begin = false;
    }
}

std::string help_text(const CommandPage& page, HelpExtent extent) {
    std::string text = wrapped(page.purpose, 0, 0, help_width) + "\n\nUsage: grainfield ";
    text += page.usage() + '\n';
    if (page.inputs.count != Command::Count::none) {
        text += "\nInputs:\n" + entry(page.inputs.placeholder, page.inputs.meaning);
    }
    const bool is_all =
        extent == HelpExtent::all || std::ranges::all_of(page.options, &OptionPage::is_usual);
    return text + (is_all ? all_options(page) : usual_options(page));
}

std::string help_text(const ProgramPage& page, const std::string& group) {
    std::string text;
    if (group.empty()) text = wrapped(page.about, 0, 0, help_width) + "\n\n";
    text += fmt::format("Usage: grainfield {}COMMAND [OPTIONS] [INPUTS]\n\nCommands:\n",
                        group.empty() ? "" : group + " ");
    for (const CommandPage& command : page.commands) {
        if (group.empty() || command.name.starts_with(group + " ")) {
            text += entry(command.name, command.purpose);
        }
    }
    if (!group.empty()) return text;
    text += "\nOptions:\n";
    for (const OptionPage& option : page.options) text += entry(option);
    if (!page.missing.empty()) {
        text +=
            '\n' + wrapped("This build is without: " + page.missing + ".", 0, 0, help_width) + '\n';
    }
    return text;
}

}  // namespace grainfield::app
