#include "app/manual_page.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "core/version.h"

namespace grainfield::app {

namespace {

constexpr const char* exit_status =
    ".SH EXIT STATUS\n"
    ".TP\n0\ndone\n"
    ".TP\n1\nfailed\n"
    ".TP\n2\nwrong usage or configuration\n"
    ".TP\n3\nbad input\n"
    ".TP\n4\noutput or disk\n"
    ".TP\n5\na check of the physics was missed\n"
    ".TP\n130, 143\ninterrupted\n";

// Text that roff takes for nothing else.
std::string escaped(std::string_view text) {
    std::string out;
    if (text.starts_with('.') || text.starts_with('\'')) out = "\\&";
    for (const char c : text) {
        if (c == '\\') {
            out += "\\e";
        } else if (c == '-') {
            out += "\\-";
        } else {
            out += c;
        }
    }
    return out;
}

std::string heading(const std::string& command, const std::string& purpose) {
    std::string title = manual_name(command);
    std::ranges::transform(title, title.begin(), [](char c) {
        return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    return fmt::format(".TH {} 1 \"\" \"grainfield {}\" \"grainfield\"\n.SH NAME\n{} \\- {}\n",
                       escaped(title), kVersion, escaped(manual_name(command)), escaped(purpose));
}

std::string entry(const OptionPage& option) {
    std::string text = ".TP\n";
    for (std::size_t i = 0; i < option.names.size(); ++i) {
        text += fmt::format("{}\\fB{}\\fR", i == 0 ? "" : ", ", escaped(option.names[i]));
    }
    if (!option.value.empty()) text += fmt::format(" \\fI{}\\fR", escaped(option.value));
    text += '\n' + escaped(option.meaning);
    if (!option.domain.empty()) text += " (" + escaped(option.domain) + ")";
    return text + '\n';
}

}  // namespace

std::string manual_name(const std::string& command) {
    std::string name = command.empty() ? "grainfield" : "grainfield-" + command;
    std::ranges::replace(name, ' ', '-');
    return name;
}

std::string manual_page(const CommandPage& page) {
    std::string text = heading(page.name, page.purpose);
    text += ".SH SYNOPSIS\n.B grainfield\n" + escaped(page.usage()) + '\n';
    if (page.inputs.count != Command::Count::none) {
        text += fmt::format(".SH INPUTS\n.TP\n\\fI{}\\fR\n{}\n", escaped(page.inputs.placeholder),
                            escaped(page.inputs.meaning));
    }
    text += ".SH OPTIONS\n";
    std::string section;
    for (const OptionPage& option : page.options) {
        if (option.section.empty()) text += entry(option);
    }
    for (const OptionPage& option : page.options) {
        if (option.section.empty()) continue;
        if (option.section != section) {
            section = option.section;
            text += fmt::format(".SS Section [{}] of a configuration\n", escaped(section));
        }
        text += entry(option);
    }
    text += exit_status;
    return text + ".SH SEE ALSO\n.BR grainfield (1)\n";
}

std::string manual_page(const ProgramPage& page) {
    std::string text = heading("", "tracking and analysis of granular layers");
    text += ".SH SYNOPSIS\n.B grainfield\n\\fICOMMAND\\fR [OPTIONS] [INPUTS]\n";
    text += ".SH DESCRIPTION\n" + escaped(page.about) + "\n.SH COMMANDS\n";
    for (const CommandPage& command : page.commands) {
        text +=
            fmt::format(".TP\n\\fB{}\\fR\n{}\n", escaped(command.name), escaped(command.purpose));
    }
    text += ".SH OPTIONS\n";
    for (const OptionPage& option : page.options) text += entry(option);
    text += exit_status;
    text += ".SH SEE ALSO\n";
    for (std::size_t i = 0; i < page.commands.size(); ++i) {
        text += fmt::format(".BR {} (1){}\n", escaped(manual_name(page.commands[i].name)),
                            i + 1 < page.commands.size() ? "," : "");
    }
    return text;
}

}  // namespace grainfield::app
