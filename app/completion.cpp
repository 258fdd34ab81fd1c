#include "app/completion.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace grainfield::app {

namespace {

std::string joined(const std::vector<std::string>& words, std::string_view between) {
    std::string text;
    for (const std::string& word : words) {
        if (!text.empty()) text += between;
        text += word;
    }
    return text;
}

// Groups such as "simulate", each with the last words of its commands.
std::vector<std::pair<std::string, std::vector<std::string>>> groups(const ProgramPage& page) {
    std::vector<std::pair<std::string, std::vector<std::string>>> found;
    for (const CommandPage& command : page.commands) {
        const auto blank = command.name.find(' ');
        if (blank == std::string::npos) continue;
        const std::string group = command.name.substr(0, blank);
        if (found.empty() || found.back().first != group)
            found.emplace_back(group, std::vector<std::string>{});
        found.back().second.push_back(command.name.substr(blank + 1));
    }
    return found;
}

struct FirstWord {
    std::string word, meaning;
};

// What may follow the name of the program.
std::vector<FirstWord> first_words(const ProgramPage& page) {
    std::vector<FirstWord> words;
    for (const CommandPage& command : page.commands) {
        const std::string word = command.name.substr(0, command.name.find(' '));
        if (!words.empty() && words.back().word == word) {
            words.back().meaning = "a group of commands";
        } else {
            words.push_back({word, command.purpose});
        }
    }
    return words;
}

bool is_long(const std::string& name) {
    return name.starts_with("--");
}

// 'text' as one word of a shell that knows single quotes only, as bash and zsh do.
std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'') {
            out += "'\\''";
        } else {
            out += c;
        }
    }
    out += '\'';
    return out;
}

std::string bash_options(const std::vector<OptionPage>& options) {
    std::vector<std::string> names, numbers, files;
    std::string cases;
    for (const OptionPage& option : options) {
        std::ranges::copy(option.names, std::back_inserter(names));
        if (option.value.empty()) continue;
        if (option.choices.empty()) {
            std::ranges::copy(option.names,
                              std::back_inserter(option.may_be_file ? files : numbers));
        } else {
            cases += fmt::format("        {}) values=\"{}\" ;;\n", joined(option.names, "|"),
                                 joined(option.choices, " "));
        }
    }
    std::string text = "        case $previous in\n" + cases;
    if (!files.empty()) text += fmt::format("        {}) return ;;\n", joined(files, "|"));
    if (!numbers.empty()) {
        text += fmt::format("        {}) compopt +o default; return ;;\n", joined(numbers, "|"));
    }
    return text + fmt::format("        esac\n        options=\"{}\"\n", joined(names, " "));
}

// "[meaning]" and what else _arguments of zsh reads must not be taken for its own signs.
std::string zsh_text(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
        out += c;
    }
    return out;
}

std::string zsh_option(const OptionPage& option) {
    std::string value;
    if (!option.value.empty()) {
        value = fmt::format(":{}:", zsh_text(option.value));
        if (!option.choices.empty())
            value += fmt::format("({})", joined(option.choices, " "));
        else if (option.may_be_file)
            value += "_files";
    }
    std::string text;
    for (const std::string& name : option.names) {
        const std::string sign = !option.value.empty() && is_long(name) ? "=" : "";
        const std::string others =
            option.names.size() > 1 ? fmt::format("({})", joined(option.names, " ")) : "";
        const std::string words =
            fmt::format("{}{}{}[{}]{}", others, name, sign, zsh_text(option.meaning), value);
        text.append(" \\\n        ").append(in_quotes(words));
    }
    return text;
}

std::string fish_condition(const std::string& command) {
    const auto blank = command.find(' ');
    if (blank == std::string::npos) return "__fish_seen_subcommand_from " + command;
    return fmt::format("__fish_seen_subcommand_from {}; and __fish_seen_subcommand_from {}",
                       command.substr(0, blank), command.substr(blank + 1));
}

// Fish knows \' and \\ between single quotes.
std::string fish_quoted(std::string_view text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') out += '\\';
        out += c;
    }
    out += '\'';
    return out;
}

std::string fish_option(const OptionPage& option, const std::string& condition) {
    std::string text = "complete -c grainfield -n " + fish_quoted(condition);
    for (const std::string& name : option.names) {
        text += is_long(name) ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    if (!option.value.empty()) {
        text += option.may_be_file ? " -r" : " -x";
        if (!option.choices.empty()) text += " -a " + fish_quoted(joined(option.choices, " "));
    }
    return text + " -d " + fish_quoted(option.meaning) + "\n";
}

}  // namespace

std::string bash_completion(const ProgramPage& page) {
    std::vector<std::string> firsts;
    for (const FirstWord& first : first_words(page)) firsts.push_back(first.word);
    for (const OptionPage& option : page.options) {
        std::ranges::copy(option.names, std::back_inserter(firsts));
    }
    std::string text =
        "# bash completion of grainfield, made by 'grainfield --completion bash'\n"
        "_grainfield() {\n"
        "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
        "    local command=${COMP_WORDS[1]} options= values=\n"
        "    COMPREPLY=()\n"
        "    # \"--name=value\" is three words here.\n"
        "    if [[ $current == = ]]; then\n"
        "        current=\n"
        "    elif [[ $previous == = ]] && ((COMP_CWORD > 1)); then\n"
        "        previous=${COMP_WORDS[COMP_CWORD-2]}\n"
        "    fi\n"
        "    if ((COMP_CWORD == 1)); then\n";
    text += fmt::format(
        "        COMPREPLY=($(compgen -W \"{}\" -- \"$current\"))\n        return\n    fi\n",
        joined(firsts, " "));
    for (const auto& [group, commands] : groups(page)) {
        text += fmt::format(
            "    if [[ $command == {} ]]; then\n"
            "        if ((COMP_CWORD == 2)); then\n"
            "            COMPREPLY=($(compgen -W \"{}\" -- \"$current\"))\n"
            "            return\n"
            "        fi\n"
            "        command+=\" ${{COMP_WORDS[2]}}\"\n"
            "    fi\n",
            group, joined(commands, " "));
    }
    text += "    case $command in\n";
    for (const CommandPage& command : page.commands) {
        text += fmt::format("    {})\n{}        ;;\n", in_quotes(command.name),
                            bash_options(command.options));
    }
    text +=
        "    esac\n"
        "    if [[ -n $values ]]; then\n"
        "        COMPREPLY=($(compgen -W \"$values\" -- \"$current\"))\n"
        "    elif [[ $current == -* ]]; then\n"
        "        COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
        "    fi\n"
        "}\n"
        "complete -o default -F _grainfield grainfield\n";
    return text;
}

std::string zsh_completion(const ProgramPage& page) {
    std::string text =
        "#compdef grainfield\n"
        "# made by 'grainfield --completion zsh'\n"
        "_grainfield() {\n"
        "    local command=${words[2]}\n"
        "    local -a known\n"
        "    if ((CURRENT == 2)); then\n"
        "        known=(\n";
    for (const FirstWord& first : first_words(page)) {
        text += "            " + in_quotes(first.word + ":" + first.meaning) + "\n";
    }
    text +=
        "        )\n"
        "        _describe command known\n"
        "        return\n"
        "    fi\n";
    for (const auto& [group, commands] : groups(page)) {
        text += fmt::format(
            "    if [[ $command == {} ]]; then\n"
            "        if ((CURRENT == 3)); then\n"
            "            known=({})\n"
            "            _describe command known\n"
            "            return\n"
            "        fi\n"
            "        command+=\" ${{words[3]}}\"\n"
            "        shift words\n"
            "        ((CURRENT--))\n"
            "    fi\n",
            group, joined(commands, " "));
    }
    text +=
        "    shift words\n"
        "    ((CURRENT--))\n"
        "    case $command in\n";
    for (const CommandPage& command : page.commands) {
        text += fmt::format("    {})\n        _arguments", in_quotes(command.name));
        for (const OptionPage& option : command.options) text += zsh_option(option);
        if (command.inputs.count != Command::Count::none) {
            text += " \\\n        " +
                    in_quotes("*:" + zsh_text(command.inputs.placeholder) + ":_files");
        }
        text += "\n        ;;\n";
    }
    return text + "    esac\n}\n_grainfield \"$@\"\n";
}

std::string fish_completion(const ProgramPage& page) {
    std::string text = "# fish completion of grainfield, made by 'grainfield --completion fish'\n";
    for (const FirstWord& first : first_words(page)) {
        text += fmt::format("complete -c grainfield -n __fish_use_subcommand -f -a {} -d {}\n",
                            first.word, fish_quoted(first.meaning));
    }
    for (const OptionPage& option : page.options)
        text += fish_option(option, "__fish_use_subcommand");
    for (const auto& [group, commands] : groups(page)) {
        text += fmt::format("complete -c grainfield -n {} -f -a {}\n",
                            fish_quoted(fmt::format("__fish_seen_subcommand_from {}; and not "
                                                    "__fish_seen_subcommand_from {}",
                                                    group, joined(commands, " "))),
                            fish_quoted(joined(commands, " ")));
    }
    for (const CommandPage& command : page.commands) {
        for (const OptionPage& option : command.options) {
            text += fish_option(option, fish_condition(command.name));
        }
    }
    return text;
}

}  // namespace grainfield::app
