#include "app/command_line.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/command.h"
#include "app/command_page.h"
#include "app/completion.h"
#include "app/config_file.h"
#include "app/exit_code.h"
#include "app/help_text.h"
#include "app/manual_page.h"
#include "app/option_set.h"
#include "core/errors.h"
#include "core/support/output_file.h"
#include "core/support/printable.h"
#include "core/support/team.h"
#include "core/version.h"
#include "pipelines/resumable.h"

namespace grainfield::app {

namespace {

constexpr const char* about =
    "Tracking and analysis of vibrated granular layers: camera frames in, particles, order and "
    "density fluctuations out.";

// The names of an option as the parser reads them.
std::string spelling(const OptionSet::Entry& entry) {
    std::string names;
    for (const std::string& name : names_of(entry)) {
        if (!names.empty()) names += ',';
        if (name == "--no-" + entry.flag) names += '!';
        names += name;
    }
    return names;
}

std::string first_word(const std::string& name) {
    return name.substr(0, name.find(' '));
}

std::string last_word(const std::string& name) {
    return name.substr(name.rfind(' ') + 1);
}

/// Where a command hangs: under `simulate` for "simulate md".
CLI::App* place(CLI::App& app, const std::string& name) {
    const std::string group = first_word(name);
    if (group == name) return &app;
    const auto known =
        app.get_subcommands([&](const CLI::App* present) { return present->get_name() == group; });
    if (!known.empty()) return known.front();
    CLI::App* parent = app.add_subcommand(group);
    parent->require_subcommand(1);
    return parent;
}

/// A command together with its place in the command-line parser.
class BoundCommand {
 public:
    BoundCommand(CLI::App& app, std::unique_ptr<Command> command)
        : command_(std::move(command)), options_(command_->name(), tables()) {
        parser_ = place(app, command_->name())->add_subcommand(last_word(command_->name()));
        parser_->allow_extras();  // refused below, with a suggestion
        const Command::Inputs inputs = command_->inputs();
        if (inputs.count != Command::Count::none) {
            // require_inputs counts them, after unknown options are told.
            parser_->add_option("inputs", inputs_)->expected(-1);
        }
        parser_->add_option("-c,--config", config_);
        for (const OptionSet::Entry& entry : options_.entries()) add(entry);
    }

    bool was_called() const { return parser_->parsed(); }

    Summary run(Session& session) {
        refuse_unknown_words();
        require_inputs();
        if (!config_.empty()) {
            apply_config_file(config_, options_);
            command_->make_room_for([this](std::string_view section, std::string_view name) {
                return given_text(section, name);
            });
        }
        for (std::size_t i = 0; i < given_.size(); ++i) {
            if (given_[i]->count() == 0) continue;
            options_.entries()[i].option.set_from_text(given_[i]->results().back());
        }
        name_output();
        session.command = command_->name();
        session.apply(common_);
        session.inputs.assign(inputs_.begin(), inputs_.end());
        session.configuration = options_.configuration();
        session.indifferent = options_.indifferent();
        session.plan = RunPlan([this](std::string text) { return options_.with_flags(text); });
        // One team for the whole run: its threads are started once and sleep between their work.
        Summary summary;
        on_team(session.threads, [&](Team&) { summary = command_->run(session); });
        return summary;
    }

    const OptionSet& options() const { return options_; }
    CommandPage page() const { return page_of(*command_, options_); }
    /// The file that options were read from; empty if there was none.
    const std::string& config() const { return config_; }

 private:
    std::vector<OptionTable> tables() {
        std::vector<OptionTable> tables = command_->options();
        tables.push_back(describe(common_));
        return tables;
    }

    void name_output() {
        for (const OptionSet::Entry& entry : options_.entries()) {
            if (entry.option.name != "output") continue;
            const std::string given = to_text(entry.option.get());
            if (given.size() > 1 && given[0] == '-') refuse_option_as_output(given);
            if (!given.empty()) continue;
            const std::string name = command_->default_output({inputs_.begin(), inputs_.end()});
            if (!name.empty()) entry.option.set_from_text(name);
        }
    }

    [[noreturn]] static void refuse_option_as_output(const std::string& given) {
        throw OptionError({.problem = fmt::format("output '{}' looks like an option", given),
                           .actual = {},
                           .expected = "a name after -o",
                           .suggestion = fmt::format("if that is its name give -o ./{}", given)});
    }

    void add(const OptionSet::Entry& entry) {
        const bool is_flag = entry.option.kind == OptionKind::flag;
        given_.push_back(is_flag ? parser_->add_flag(spelling(entry))
                                 : parser_->add_option(spelling(entry)));
    }

    std::string given_text(std::string_view section, std::string_view name) const {
        for (std::size_t i = 0; i < given_.size(); ++i) {
            const OptionSet::Entry& entry = options_.entries()[i];
            if (entry.section != section || entry.option.name != name) continue;
            if (given_[i]->count() > 0) return given_[i]->results().back();
        }
        return {};
    }

    void require_inputs() const {
        const Command::Inputs wanted = command_->inputs();
        if (wanted.count == Command::Count::one && inputs_.size() > 1) {
            throw OptionError({.problem = fmt::format("'{}' takes one input", command_->name()),
                               .actual = fmt::format("{}: '{}', '{}'{}", inputs_.size(), inputs_[0],
                                                     inputs_[1], inputs_.size() > 2 ? ", …" : ""),
                               .expected = wanted.placeholder,
                               .suggestion = {}});
        }
        if (wanted.count == Command::Count::none || wanted.count == Command::Count::any ||
            !inputs_.empty()) {
            return;
        }
        throw OptionError(
            {.problem = fmt::format("'{}' has no input", command_->name()),
             .actual = {},
             .expected = fmt::format("{} {} ({})",
                                     wanted.count == Command::Count::many ? "at least one" : "one",
                                     wanted.placeholder, wanted.meaning),
             .suggestion = fmt::format("see 'grainfield {} --help'", command_->name())});
    }

    void refuse_unknown_words() const {
        std::vector<std::string> unknown = parser_->remaining();
        std::erase(unknown, "--");  // what follows it is no option
        if (unknown.empty()) return;
        std::string_view word = unknown.front();
        word = word.substr(std::min(word.size(), word.find_first_not_of('-')));
        word = word.substr(0, word.find('='));
        std::string advice = command_->advice_on(word);
        const std::string nearest = nearest_name(word, options_.flags());
        if (advice.empty()) {
            advice = nearest.empty() ? fmt::format("see 'grainfield {} --help'", command_->name())
                                     : fmt::format("did you mean '--{}'?", nearest);
        }
        std::error_code unreachable;
        if (std::filesystem::path(unknown.front()).extension() == ".toml" &&
            std::filesystem::exists(unknown.front(), unreachable)) {
            throw OptionError({.problem = fmt::format("'{}' takes no input", command_->name()),
                               .actual = unknown.front(),
                               .expected = "a file of options after -c",
                               .suggestion = fmt::format("give '-c {}'", unknown.front())});
        }
        throw OptionError(
            {.problem = fmt::format("'{}' does not know '{}'", command_->name(), unknown.front()),
             .actual = {},
             .expected = {},
             .suggestion = advice});
    }

    std::unique_ptr<Command> command_;
    CommonOptions common_;
    OptionSet options_;
    CLI::App* parser_ = nullptr;
    std::vector<CLI::Option*> given_;  // parallel to the entries of options_
    std::vector<std::string> inputs_;
    std::string config_;
};

void print_warnings(const RunPlan& plan) {
    for (const Warning& warning : plan.warnings()) {
        fmt::print(stderr, "warning: {}\n", printable(warning.text));
    }
}

// To standard output, all of it: what cannot be written is an error, also of help.
void put(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw OutputError("cannot write to standard output.");
}

void print_summary(const Session& session, const Summary& summary) {
    if (session.common.json) {
        using Json = nlohmann::ordered_json;
        put(json_summary(session, summary).dump(2, ' ', false, Json::error_handler_t::replace) +
            "\n");
    } else if (summary.is_table) {
        put(summary.text);
    } else if (!session.common.quiet) {
        if (session.common.verbose && !session.common.explain) put(printable(session.plan.text()));
        put(printable(summary.text));
    }
}

// Says what was being worked on where the message names no file: rooms that compute know none.
std::string with_files(std::string message, const BoundCommand& command, const Session& session) {
    const auto is_named = [&message](const std::string& file) {
        return !file.empty() && message.find(file) != std::string::npos;
    };
    std::string files;
    if (!session.inputs.empty() && std::ranges::none_of(session.inputs, [&](const auto& input) {
            return is_named(input.string());
        })) {
        files = fmt::format("input '{}'", session.inputs.front().string());
        if (session.inputs.size() > 1) {
            files += fmt::format(" and {} more", session.inputs.size() - 1);
        }
    }
    if (!command.config().empty() && !is_named(command.config())) {
        files += fmt::format("{}options of '{}'", files.empty() ? "" : "; ", command.config());
    }
    if (files.empty()) return message;
    return fmt::format("{} ({})", message, files);
}

int run(BoundCommand& command) {
    Session session;
    int code = 0;
    try {
        const Summary summary = command.run(session);
        print_summary(session, summary);
        if (!summary.failure.empty()) throw PhysicsError(summary.failure);
        code = summary.signal != 0 ? exit_code(summary.signal) : static_cast<int>(summary.code);
    } catch (const pipelines::AlreadyComplete& complete) {
        Summary summary;
        summary.text = std::string(complete.what()) + "\n";
        summary.facts["complete"] = true;
        print_summary(session, summary);
    } catch (const std::bad_alloc& error) {
        fmt::print(
            stderr,
            "error: out of memory. Free some or raise its limit (ulimit -v); memory grows with "
            "the pixels of one frame, the particles and --threads, not with the number of "
            "frames.\n");
        code = exit_code(error);
    } catch (const std::exception& error) {
        fmt::print(
            stderr, "error: {}\n",
            printable(with_files(command.options().with_flags(error.what()), command, session)));
        code = exit_code(error);
    }
    print_warnings(session.plan);
    return code;
}

// What the parser says of an option given twice or without its value, in words.
std::string in_words(const std::string& problem) {
    const std::string option = problem.substr(0, problem.find(':'));
    constexpr std::string_view twice = ": At Most 1 required but received ";
    if (const auto at = problem.find(twice); at != std::string::npos) {
        return fmt::format("{} is given {} times, expected once", option,
                           problem.substr(at + twice.size()));
    }
    if (problem.find(": 1 required ") != std::string::npos) {
        return fmt::format("{} has no value", option);
    }
    return problem;
}

std::optional<std::string> unknown_command(int argc, const char* const* argv,
                                           const std::vector<std::string>& names) {
    if (argc < 2 || argv[1][0] == '-' || std::ranges::find(names, argv[1]) != names.end()) {
        return std::nullopt;
    }
    const std::string nearest = nearest_name(argv[1], names);
    return fmt::format("unknown command '{}'{}", argv[1],
                       nearest.empty() ? "; see 'grainfield --help'."
                                       : fmt::format("; did you mean '{}'?", nearest));
}

OptionPage own_option(std::vector<std::string> names, std::string value, std::string words,
                      std::vector<std::string> choices = {}) {
    OptionPage page{.names = std::move(names),
                    .value = std::move(value),
                    .meaning = std::move(words),
                    .domain = {},
                    .section = {},
                    .choices = std::move(choices),
                    .is_usual = true};
    page.may_be_file = page.value == "FOLDER";
    return page;
}

ProgramPage program_page(const std::vector<std::unique_ptr<BoundCommand>>& commands) {
    ProgramPage page{.about = about, .options = {}, .commands = {}, .missing = GRAINFIELD_MISSING};
    page.options = {
        own_option({"-h", "--help"}, "", "print this, then stop; of a command: its usual options"),
        own_option({"--version"}, "", "print the version, then stop"),
        own_option({"--man"}, "COMMAND", "print the manual page of a command, for 'man -l -'"),
        own_option({"--completion"}, "SHELL", "print the completion script for bash, zsh or fish",
                   {"bash", "zsh", "fish"}),
        own_option({"--write-manual"}, "FOLDER",
                   "write all manual pages and completion scripts into an existing folder")};
    for (const auto& command : commands) page.commands.push_back(command->page());
    return page;
}

std::string completion(const ProgramPage& page, const std::string& shell) {
    if (shell == "bash") return bash_completion(page);
    if (shell == "zsh") return zsh_completion(page);
    if (shell == "fish") return fish_completion(page);
    throw OptionError({.problem = "option 'completion' has a wrong value",
                       .actual = fmt::format("'{}'", shell),
                       .expected = "one of bash, zsh, fish",
                       .suggestion = {}});
}

std::string manual(const ProgramPage& page, const std::string& command) {
    if (command.empty()) return manual_page(page);
    if (const CommandPage* found = page.find(command)) return manual_page(*found);
    throw OptionError({.problem = fmt::format("there is no command '{}'", command),
                       .actual = {},
                       .expected = {},
                       .suggestion = "see 'grainfield --help'"});
}

// The names under which the shells and man look for them.
void write_manual(const ProgramPage& page, const std::filesystem::path& folder) {
    const auto write = [&folder](const std::string& name, const std::string& text) {
        write_file(folder / name, text, Overwrite::force);
    };
    write(manual_name("") + ".1", manual_page(page));
    for (const CommandPage& command : page.commands) {
        write(manual_name(command.name) + ".1", manual_page(command));
    }
    write("grainfield", bash_completion(page));
    write("_grainfield", zsh_completion(page));
    write("grainfield.fish", fish_completion(page));
}

// What the program says about itself: nothing if that is not what it is asked for.
std::optional<int> document(const std::vector<std::string>& words, const ProgramPage& page) {
    if (words.empty()) return std::nullopt;
    std::string rest;
    for (std::size_t i = 1; i < words.size(); ++i) rest += (i > 1 ? " " : "") + words[i];
    try {
        if (words[0] == "--man") {
            put(manual(page, rest));
        } else if (words[0] == "--completion") {
            put(completion(page, rest));
        } else if (words[0] == "--write-manual") {
            write_manual(page, rest);
        } else {
            return std::nullopt;
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "error: {}\n", printable(error.what()));
        return exit_code(error);
    }
    return static_cast<int>(ExitCode::done);
}

// The exit code of saying that.
int said(std::string_view text) {
    try {
        put(text);
    } catch (const OutputError& error) {
        fmt::print(stderr, "error: {}\n", error.what());
        return exit_code(error);
    }
    return static_cast<int>(ExitCode::done);
}

// Help of the command, the group of commands, or the program that the words name.
std::string help(const CLI::App& app, const ProgramPage& page, HelpExtent extent) {
    std::string name;
    for (auto called = app.get_subcommands(); !called.empty();
         called = called.front()->get_subcommands()) {
        name += (name.empty() ? "" : " ") + called.front()->get_name();
    }
    const CommandPage* command = page.find(name);
    return command == nullptr ? help_text(page, name) : help_text(*command, extent);
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
    return run_command_line(argc, argv, make_commands());
}

int run_command_line(int argc, const char* const* argv,
                     std::vector<std::unique_ptr<Command>> commands) {
    CLI::App app(about, "grainfield");
    app.set_help_all_flag("--help-all");
    app.set_version_flag("--version", std::string("grainfield ") + kVersion);
    app.require_subcommand(1);
    std::vector<std::unique_ptr<BoundCommand>> bound;
    std::vector<std::string> names;
    for (auto& command : commands) {
        names.push_back(first_word(command->name()));
        bound.push_back(std::make_unique<BoundCommand>(app, std::move(command)));
    }
    if (const auto code = document({argv + 1, argv + argc}, program_page(bound))) return *code;
    if (const auto problem = unknown_command(argc, argv, names)) {
        fmt::print(stderr, "error: {}\n", printable(*problem));
        return static_cast<int>(ExitCode::wrong_usage);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        return said(help(app, program_page(bound), HelpExtent::usual));
    } catch (const CLI::CallForAllHelp&) {
        return said(help(app, program_page(bound), HelpExtent::all));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return said(fmt::format("{}\n", error.what()));  // version
        fmt::print(stderr, "error: {}; see --help.\n", printable(in_words(error.what())));
        return static_cast<int>(ExitCode::wrong_usage);
    }
    const auto called =
        std::ranges::find_if(bound, [](const auto& command) { return command->was_called(); });
    return run(**called);
}

}  // namespace grainfield::app
