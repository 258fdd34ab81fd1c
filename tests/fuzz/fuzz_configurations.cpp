#include <memory>
#include <vector>

#include "app/command.h"
#include "app/config_file.h"
#include "app/option_set.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

namespace {

/// A command with its options, as the command line has it.
struct Target {
    explicit Target(std::unique_ptr<app::Command> of) : command(std::move(of)) {
        tables = command->options();
        tables.push_back(describe(common));
        options = std::make_unique<app::OptionSet>(command->name(), tables);
        for (const app::OptionSet::Entry& entry : options->entries()) {
            defaults.push_back(entry.option.get());
        }
    }
    void reset() const {
        for (std::size_t i = 0; i < defaults.size(); ++i) {
            options->entries()[i].option.set(defaults[i]);
        }
    }

    app::CommonOptions common;
    std::unique_ptr<app::Command> command;
    std::vector<OptionTable> tables;
    std::unique_ptr<app::OptionSet> options;
    std::vector<OptionValue> defaults;
};

const std::vector<std::unique_ptr<Target>>& targets() {
    static const auto list = [] {
        std::vector<std::unique_ptr<Target>> all;
        for (auto& command : app::make_commands()) {
            all.push_back(std::make_unique<Target>(std::move(command)));
        }
        return all;
    }();
    return list;
}

// What was taken can be written down, and the same options come from that.
void require_same_again(const Target& target) {
    const std::string text = app::config_text(target.tables, "");
    const Input copy(text, ".copy.toml");
    target.reset();
    promise(is_taken(copy, [&] { app::apply_config_file(copy.path(), *target.options); }),
            "options that are written are options");
    promise(app::config_text(target.tables, "") == text,
            "options that are written read back the same");
}

}  // namespace

bool read_configurations(std::string_view bytes) {
    // "# C" on the first line chooses the command; other files are one of the first.
    std::size_t number = 0;
    if (bytes.size() > 2 && bytes.starts_with("# ")) {
        number = static_cast<unsigned char>(bytes[2] - 'A') % targets().size();
    }
    const Target& target = *targets()[number];
    const Input input(bytes, ".toml");
    target.reset();
    const bool taken =
        is_taken(input, [&] { app::apply_config_file(input.path(), *target.options); });
    if (taken) require_same_again(target);
    return taken;
}

}  // namespace grainfield::fuzz
