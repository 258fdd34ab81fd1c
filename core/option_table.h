#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace grainfield {

using OptionValue = std::variant<bool, std::int64_t, double, std::string>;

enum class OptionKind { flag, integer, number, text, choice };

/// One row of an option table: everything that the command line, the TOML file, the help text, the
/// range check and the record of a run need to know about one field.
struct Option {
    std::string name;     ///< kebab-case, the same on the command line and in the TOML file
    std::string unit;     ///< "px", "a", "-"; empty for flags, text and choices
    std::string meaning;  ///< one line for `--help`
    OptionKind kind = OptionKind::text;
    bool may_be_auto = false;  ///< accepts the text "auto": the program estimates it
    double minimum = -std::numeric_limits<double>::infinity();
    double maximum = std::numeric_limits<double>::infinity();
    std::vector<std::string> choices;
    OptionValue default_value;  ///< as it was when the table was made

    std::function<OptionValue()> get;  ///< the present value; text "auto" where not set

    /// Throws OptionError (name, value, range or choices, nearest choice) and leaves the field as
    /// it was if the value is of the wrong kind, NaN, or out of range. Integers convert to numbers.
    std::function<void(const OptionValue&)> set;

    /// Same, from the text of a command line.
    void set_from_text(std::string_view text) const;

    /// "[px] 3 … 400, default auto" or "one of dark, bright, auto; default auto".
    std::string domain_text() const;
};

struct Range {
    double minimum = -std::numeric_limits<double>::infinity();
    double maximum = std::numeric_limits<double>::infinity();
};

/// The options of one algorithm, bound to the fields of one options struct.
///
///     OptionTable describe(LinkOptions& o) {
///         OptionTable t("link");
///         t.number("search-range", o.search_range, "px", {0, 1e4}, "largest step between frames");
///         return t;
///     }
///
/// The struct must outlive the table. Defaults are the values at the time of binding.
class OptionTable {
 public:
    explicit OptionTable(std::string section) : section_(std::move(section)) {}

    void flag(std::string name, bool& field, std::string meaning);
    void integer(std::string name, int& field, std::string unit, Range range, std::string meaning);
    void integer(std::string name, std::int64_t& field, std::string unit, Range range,
                 std::string meaning);
    void number(std::string name, double& field, std::string unit, Range range,
                std::string meaning);
    /// Empty means "auto".
    void number(std::string name, std::optional<double>& field, std::string unit, Range range,
                std::string meaning);
    void text(std::string name, std::string& field, std::string meaning);

    template <class Enum>
    void choice(std::string name, Enum& field, std::vector<std::pair<std::string, Enum>> values,
                std::string meaning) {
        std::vector<std::string> names;
        for (const auto& [text, value] : values) names.push_back(text);
        add_choice(
            std::move(name), std::move(names),
            [&field, values] {
                for (const auto& [text, value] : values) {
                    if (value == field) return text;
                }
                return std::string();
            },
            [&field, values](const std::string& wanted) {
                for (const auto& [text, value] : values) {
                    if (text == wanted) field = value;
                }
            },
            std::move(meaning));
    }

    const std::string& section() const { return section_; }
    const std::vector<Option>& rows() const { return rows_; }
    const Option* find(std::string_view name) const;

    /// Sets option `name`; throws OptionError with the nearest known name if there is none.
    void set(std::string_view name, const OptionValue& value) const;

 private:
    void add_choice(std::string name, std::vector<std::string> names,
                    std::function<std::string()> get, std::function<void(const std::string&)> set,
                    std::string meaning);

    std::string section_;
    std::vector<Option> rows_;
};

/// The value as it stands on a command line ("true", "12", "0.35", "dark").
std::string to_text(const OptionValue& value);

/// The candidate closest to `word` by edit distance, empty if none is close enough to be meant.
std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace grainfield
