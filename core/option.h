#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace grainfield {

using OptionValue = std::variant<bool, std::int64_t, double, std::string>;

struct Range {
    double minimum = -std::numeric_limits<double>::infinity();
    double maximum = std::numeric_limits<double>::infinity();
    bool may_be_infinite = false;  ///< "inf" is a value
};

/// How many elements a list may have. None is accepted too where that is the default.
struct Count {
    std::size_t minimum = 1;
    std::size_t maximum = std::numeric_limits<std::size_t>::max();
};

/// What stands for a value that the program estimates.
constexpr const char* automatic = "auto";

enum class OptionKind { flag, integer, number, text, choice };

/// What depends on an option.
enum class Effect {
    result,  ///< the numbers that a run makes
    extent,  ///< how far the run goes: one that is gone on with may be made longer
    work,    ///< how they are made, or whether: with another value they are the same
    call     ///< this call alone, as going on with an earlier one: not part of a run's record
};

/// One row of an option table: everything that the command line, the TOML file, the help text, the
/// range check and the record of a run need to know about one field.
struct Option {
    std::string name;  ///< kebab-case, the same on the command line and in the TOML file
    std::vector<std::string> other_names{};  ///< accepted in its place, e.g. what it was called
    std::string unit;                        ///< "px", "a", "-"; empty for flags, text and choices
    std::string meaning;                     ///< one line for `--help`
    OptionKind kind = OptionKind::text;
    bool is_list = false;      ///< holds several values of this kind; as a value: "1,10"
    bool may_be_auto = false;  ///< accepts the text "auto": the program estimates it
    Range range;               ///< of a number, or of each number of a list
    Count count;               ///< of the elements of a list
    std::vector<std::string> choices;
    OptionValue default_value;  ///< as it was when the table was made
    Effect effect = Effect::result;
    const void* field = nullptr;  ///< what the row is bound to

    bool is_called(std::string_view word) const;  ///< by its name or another one

    std::function<OptionValue()> get;  ///< the present value; text "auto" where not set

    /// Throws OptionError (name, value, range or choices, nearest choice) and leaves the field as
    /// it was if the value is of the wrong kind, NaN, or out of range. Integers convert to numbers,
    /// a single number or name to a list of one.
    std::function<void(const OptionValue&)> set;

    /// Same, from the text of a command line.
    void set_from_text(std::string_view text) const;

    /// The value that a text means, or one element of a list, before the check of its range;
    /// nothing if it is of another kind.
    std::optional<OptionValue> parsed(std::string_view text) const;

    /// "[px] 3 … 400, default auto" or "one of dark, bright, auto; default auto".
    std::string domain_text() const;

    /// Throws OptionError; `element` is the part of a list that is wrong.
    [[noreturn]] void refuse(const OptionValue& value, std::string_view element = {}) const;
};

/// The value as it stands on a command line ("true", "12", "0.35", "dark").
std::string to_text(const OptionValue& value);

/// The candidate closest to `word` by edit distance, empty if none is close enough to be meant.
std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace grainfield
