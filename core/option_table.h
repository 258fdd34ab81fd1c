#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/option.h"

namespace grainfield {

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
    /// Empty means "auto".
    void flag(std::string name, std::optional<bool>& field, std::string meaning);
    void integer(std::string name, int& field, std::string unit, Range range, std::string meaning);
    void integer(std::string name, std::int64_t& field, std::string unit, Range range,
                 std::string meaning);
    /// Empty means "auto".
    void integer(std::string name, std::optional<int>& field, std::string unit, Range range,
                 std::string meaning);
    void number(std::string name, double& field, std::string unit, Range range,
                std::string meaning);
    /// Empty means "auto".
    void number(std::string name, std::optional<double>& field, std::string unit, Range range,
                std::string meaning);
    void text(std::string name, std::string& field, std::string meaning);

    /// Lists: "1,10" on the command line, "1,10" or [1, 10] in a TOML file. The range holds for
    /// each element; blanks around an element do not count.
    void integers(std::string name, std::vector<int>& field, std::string unit, Range range,
                  std::string meaning, Count count = {});
    void integers(std::string name, std::vector<std::int64_t>& field, std::string unit, Range range,
                  std::string meaning, Count count = {});
    void numbers(std::string name, std::vector<double>& field, std::string unit, Range range,
                 std::string meaning, Count count = {});
    /// Empty means "auto".
    void numbers(std::string name, std::optional<std::vector<double>>& field, std::string unit,
                 Range range, std::string meaning, Count count = {});
    /// Some of `choices`.
    void names(std::string name, std::vector<std::string>& field, std::vector<std::string> choices,
               std::string meaning, Count count = {});

    template <class Enum>
    void choice(std::string name, Enum& field, std::vector<std::pair<std::string, Enum>> values,
                std::string meaning) {
        std::vector<std::string> names;
        for (const auto& [text, value] : values) names.push_back(text);
        add_choice(
            std::move(name), std::move(names), &field,
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

    /// The option added last may be called so too.
    void also_called(std::string name) { rows_.back().other_names.push_back(std::move(name)); }

    /// What depends on the option added last.
    void affects(Effect effect) { rows_.back().effect = effect; }

    const std::string& section() const { return section_; }
    const std::vector<Option>& rows() const { return rows_; }
    const Option* find(std::string_view name) const;
    /// The row that is bound to this field of the options; throws std::logic_error if there is
    /// none.
    const Option& row_of(const void* field) const;

    /// Sets option `name`; throws OptionError with the nearest known name if there is none.
    void set(std::string_view name, const OptionValue& value) const;

 private:
    void add_choice(std::string name, std::vector<std::string> names, const void* field,
                    std::function<std::string()> get, std::function<void(const std::string&)> set,
                    std::string meaning);

    std::string section_;
    std::vector<Option> rows_;
};

}  // namespace grainfield
