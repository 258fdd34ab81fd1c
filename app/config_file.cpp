#include "app/config_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <variant>

#include <fmt/format.h>

#include "core/errors.h"
#include "pipelines/detail/toml_text.h"

namespace grainfield::app {

namespace {

class ConfigReader {
 public:
    ConfigReader(std::string file, const OptionSet& options)
        : file_(std::move(file)), options_(options) {}

    void apply(const toml::table& root) const {
        for (const auto& [key, node] : root) {
            if (const toml::table* section = node.as_table()) {
                apply_section(std::string(key.str()), *section);
            } else {
                set({}, std::string(key.str()), node);
            }
        }
    }

    std::string place(const toml::source_region& source) const {
        return fmt::format("'{}' line {}", file_, source.begin.line);
    }

 private:
    void apply_section(const std::string& section, const toml::table& table) const {
        if (section.empty() || !options_.has_section(section)) {
            refuse_unknown(fmt::format("section [{}]", section), section, options_.sections(),
                           table.source());
        }
        for (const auto& [key, node] : table) set(section, std::string(key.str()), node);
    }

    void set(const std::string& section, const std::string& key, const toml::node& node) const {
        const OptionSet::Entry* entry = options_.find(section, key);
        if (entry == nullptr) {
            const std::string what = section.empty()
                                         ? fmt::format("key '{}'", key)
                                         : fmt::format("key '{}' in [{}]", key, section);
            refuse_unknown(what, key, options_.keys(section), node.source());
        }
        const auto value =
            entry->option.is_list && node.is_array() ? to_list(*node.as_array()) : to_value(node);
        if (!value) {
            throw OptionError(
                {.problem = fmt::format("{}: '{}' has a wrong value", place(node.source()), key),
                 .actual = "a list, table or date",
                 .expected =
                     fmt::format(fmt::runtime(entry->option.is_list ? "a list such as [{0}, {0}]"
                                                                    : "a single {}"),
                                 kind_name(entry->option.kind)),
                 .suggestion = {}});
        }
        try {
            set_value(entry->option, *value);
        } catch (const OptionError& error) {
            const std::string written = key == entry->option.name ? "" : fmt::format("'{}': ", key);
            throw OptionError(fmt::format("{}: {}{}", place(node.source()), written, error.what()));
        }
    }

    // In another spelling: "500Hz" of an option in 1/s.
    static bool is_with_unit(const Option& option, const std::string& text) {
        const auto is = [](char c, char first, char last) { return c >= first && c <= last; };
        if (text.empty() || !is(text.front(), '0', '9')) return false;
        const bool ends_with_letter = is(text.back(), 'a', 'z') || is(text.back(), 'A', 'Z');
        return ends_with_letter && option.parsed(text).has_value();
    }

    // A number with its unit is a text in TOML: "10.09px".
    static void set_value(const Option& option, const OptionValue& value) {
        const auto* text = std::get_if<std::string>(&value);
        const bool may_have = text != nullptr && !option.unit.empty() && option.unit != "-";
        if (may_have && (text->ends_with(option.unit) || is_with_unit(option, *text))) {
            return option.set_from_text(*text);
        }
        option.set(value);
    }

    static std::optional<OptionValue> to_value(const toml::node& node) {
        if (const auto* flag = node.as_boolean()) return flag->get();
        if (const auto* whole = node.as_integer()) return whole->get();
        if (const auto* real = node.as_floating_point()) return real->get();
        if (const auto* text = node.as_string()) return text->get();
        return std::nullopt;
    }

    // "1,10" for [1, 10]; nothing if an element is no single value or holds a comma.
    static std::optional<OptionValue> to_list(const toml::array& array) {
        std::string text;
        for (const toml::node& node : array) {
            const auto element = to_value(node);
            if (!element) return std::nullopt;
            const std::string word = to_text(*element);
            if (word.find(',') != std::string::npos) return std::nullopt;
            text += (text.empty() ? "" : ",") + word;
        }
        return text;
    }

    static const char* kind_name(OptionKind kind) {
        switch (kind) {
            case OptionKind::flag:
                return "true or false";
            case OptionKind::integer:
                return "integer";
            case OptionKind::number:
                return "number";
            case OptionKind::text:
            case OptionKind::choice:
                return "text";
        }
        return "value";
    }

    [[noreturn]] void refuse_unknown(const std::string& what, const std::string& word,
                                     const std::vector<std::string>& known,
                                     const toml::source_region& source) const {
        std::string suggestion;
        if (const std::string nearest = nearest_name(word, known); !nearest.empty()) {
            suggestion = fmt::format("did you mean '{}'?", nearest);
        } else {
            suggestion = fmt::format("see 'grainfield {} --help'", options_.command());
        }
        throw OptionError({.problem = fmt::format("{}: unknown {}", place(source), what),
                           .actual = {},
                           .expected = {},
                           .suggestion = suggestion});
    }

    std::string file_;
    const OptionSet& options_;
};

// A TOML basic string.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') out += '\\';
        if (code < 0x20 || code == 0x7F) {
            out += fmt::format("\\u{:04X}", code);
        } else {
            out += c;
        }
    }
    return out + '"';
}

std::string value_text(const Option& option) {
    const OptionValue value = option.get();
    const std::string text = to_text(value);
    const bool is_plain = !std::holds_alternative<std::string>(value);
    return is_plain ? text : quoted(text);
}

std::string lines_of(const OptionTable& table) {
    std::string lines;
    for (const Option& option : table.rows()) {
        if (option.effect == Effect::call) continue;
        const std::string unit = option.unit.empty() ? "" : fmt::format("[{}] ", option.unit);
        lines +=
            fmt::format("{}{} = {}  # {}{}\n", option.get() == option.default_value ? "# " : "",
                        option.name, value_text(option), unit, option.meaning);
    }
    return lines;
}

std::string read_text(const std::filesystem::path& path) {
    // Before it is opened: opening a pipe waits for somebody to write into it.
    std::error_code error;
    const auto type = std::filesystem::status(path, error).type();
    const bool is_special = std::filesystem::exists(path, error) &&
                            type != std::filesystem::file_type::regular &&
                            type != std::filesystem::file_type::directory;
    std::ifstream file;
    if (type == std::filesystem::file_type::regular) file.open(path, std::ios::binary);
    if (!file.is_open()) {
        throw InputError({.problem = fmt::format("cannot read configuration '{}'", path.string()),
                          .actual = is_special ? "it is a pipe or a device" : "",
                          .expected = "a readable TOML file",
                          .suggestion = {}});
    }
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

void apply_config_file(const std::filesystem::path& path, const OptionSet& options) {
    const std::string text = read_text(path);
    const ConfigReader reader(path.string(), options);
    toml::table root;
    try {
        root = pipelines::parsed_toml(text);
    } catch (const toml::parse_error& error) {
        throw OptionError({.problem = reader.place(error.source()) + ": not valid TOML",
                           .actual = std::string(error.description()),
                           .expected = {},
                           .suggestion = {}});
    }
    reader.apply(root);
}

std::string config_text(const std::vector<OptionTable>& tables, const std::string& heading) {
    std::string out = "# ";
    for (const char c : heading) out += c == '\n' ? std::string("\n# ") : std::string(1, c);
    out += '\n';
    // A key stands under the section before it, and each section once.
    std::vector<std::string> sections{""};
    for (const OptionTable& table : tables) {
        if (std::ranges::find(sections, table.section()) == sections.end()) {
            sections.push_back(table.section());
        }
    }
    for (const std::string& section : sections) {
        out += section.empty() ? "\n" : fmt::format("\n[{}]\n", section);
        for (const OptionTable& table : tables) {
            if (table.section() == section) out += lines_of(table);
        }
    }
    return out;
}

}  // namespace grainfield::app
