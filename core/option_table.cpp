#include "core/option_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

constexpr const char* automatic = "auto";

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

template <class Number>
std::optional<Number> parse(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::string with_unit(const Option& option) {
    return option.unit.empty() || option.unit == "-" ? "" : " [" + option.unit + "]";
}

std::string range_text(const Option& option) {
    const bool has_minimum = std::isfinite(option.minimum);
    const bool has_maximum = std::isfinite(option.maximum);
    if (has_minimum && has_maximum)
        return fmt::format("{:g} … {:g}", option.minimum, option.maximum);
    if (has_minimum) return fmt::format("≥ {:g}", option.minimum);
    if (has_maximum) return fmt::format("≤ {:g}", option.maximum);
    return {};
}

std::string joined(const std::vector<std::string>& names, bool with_auto) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    if (with_auto) text += std::string(text.empty() ? "" : ", ") + automatic;
    return text;
}

std::string expectation(const Option& option) {
    std::string text;
    switch (option.kind) {
        case OptionKind::flag:
            return "true or false";
        case OptionKind::text:
            return "a text";
        case OptionKind::choice:
            return "one of " + joined(option.choices, option.may_be_auto);
        case OptionKind::integer:
            text = "an integer";
            break;
        case OptionKind::number:
            text = "a number";
            break;
    }
    if (const std::string range = range_text(option); !range.empty()) text += " " + range;
    text += with_unit(option);
    if (option.may_be_auto) text += " or auto";
    return text;
}

[[noreturn]] void refuse(const Option& option, const OptionValue& value) {
    std::string suggestion;
    if (option.kind == OptionKind::choice) {
        if (const auto* word = std::get_if<std::string>(&value)) {
            const std::string nearest = nearest_name(*word, option.choices);
            if (!nearest.empty()) suggestion = fmt::format("did you mean '{}'?", nearest);
        }
    }
    throw OptionError({.problem = fmt::format("option '{}' has a wrong value", option.name),
                       .actual = fmt::format("'{}'", to_text(value)),
                       .expected = expectation(option),
                       .suggestion = suggestion});
}

bool in_range(const Option& option, double value) {
    return std::isfinite(value) && value >= option.minimum && value <= option.maximum;
}

bool is_auto(const OptionValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    return text != nullptr && *text == automatic;
}

double to_number(const Option& option, const OptionValue& value) {
    double number = std::numeric_limits<double>::quiet_NaN();
    if (const auto* real = std::get_if<double>(&value)) number = *real;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        number = static_cast<double>(*whole);
    }
    if (!in_range(option, number)) refuse(option, value);
    return number;
}

template <class Integer>
Integer to_integer(const Option& option, const OptionValue& value) {
    const auto* whole = std::get_if<std::int64_t>(&value);
    if (whole == nullptr || !std::in_range<Integer>(*whole) ||
        !in_range(option, static_cast<double>(*whole))) {
        refuse(option, value);
    }
    return static_cast<Integer>(*whole);
}

Option make_row(std::string name, std::string unit, Range range, std::string meaning,
                OptionKind kind) {
    Option row;
    row.name = std::move(name);
    row.unit = std::move(unit);
    row.meaning = std::move(meaning);
    row.kind = kind;
    row.minimum = range.minimum;
    row.maximum = range.maximum;
    return row;
}

// Completes a row: `assign` gets the row as it will be described in messages, and the value.
template <class Get, class Assign>
void bind(std::vector<Option>& rows, Option row, Get get, Assign assign) {
    row.get = get;
    row.default_value = get();
    const Option description = row;
    row.set = [description, assign](const OptionValue& value) { assign(description, value); };
    rows.push_back(std::move(row));
}

template <class Integer>
void bind_integer(std::vector<Option>& rows, Option row, Integer& field) {
    bind(
        rows, std::move(row),
        [&field]() -> OptionValue { return static_cast<std::int64_t>(field); },
        [&field](const Option& option, const OptionValue& value) {
            field = to_integer<Integer>(option, value);
        });
}

}  // namespace

void Option::set_from_text(std::string_view text) const {
    const std::string word(text);
    if (may_be_auto && text == automatic) return set(word);
    switch (kind) {
        case OptionKind::flag:
            for (const char* yes : {"true", "yes", "on", "1"}) {
                if (text == yes) return set(true);
            }
            for (const char* no : {"false", "no", "off", "0"}) {
                if (text == no) return set(false);
            }
            break;
        case OptionKind::integer:
            if (const auto whole = parse<std::int64_t>(text)) return set(*whole);
            break;
        case OptionKind::number:
            if (const auto real = parse<double>(text)) return set(*real);
            break;
        case OptionKind::text:
        case OptionKind::choice:
            return set(word);
    }
    refuse(*this, word);
}

std::string Option::domain_text() const {
    std::string text;
    if (kind == OptionKind::choice) text = "one of " + joined(choices, may_be_auto);
    if (!unit.empty()) text = "[" + unit + "]";
    if (const std::string range = range_text(*this); !range.empty()) {
        text += (text.empty() ? "" : " ") + range;
    }
    if (kind == OptionKind::flag && default_value == OptionValue(false)) return text;
    const std::string shown = to_text(default_value);
    if (shown.empty()) return text;
    return text +
           (text.empty()                 ? ""
            : kind == OptionKind::choice ? "; "
                                         : ", ") +
           "default " + shown;
}

void OptionTable::flag(std::string name, bool& field, std::string meaning) {
    bind(
        rows_, make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::flag),
        [&field]() -> OptionValue { return field; },
        [&field](const Option& option, const OptionValue& value) {
            const auto* on = std::get_if<bool>(&value);
            if (on == nullptr) refuse(option, value);
            field = *on;
        });
}

void OptionTable::integer(std::string name, int& field, std::string unit, Range range,
                          std::string meaning) {
    bind_integer(
        rows_,
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::integer),
        field);
}

void OptionTable::integer(std::string name, std::int64_t& field, std::string unit, Range range,
                          std::string meaning) {
    bind_integer(
        rows_,
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::integer),
        field);
}

void OptionTable::number(std::string name, double& field, std::string unit, Range range,
                         std::string meaning) {
    bind(
        rows_,
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::number),
        [&field]() -> OptionValue { return field; },
        [&field](const Option& option, const OptionValue& value) {
            field = to_number(option, value);
        });
}

void OptionTable::number(std::string name, std::optional<double>& field, std::string unit,
                         Range range, std::string meaning) {
    Option row =
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::number);
    row.may_be_auto = true;
    bind(
        rows_, std::move(row),
        [&field]() -> OptionValue {
            if (field) return *field;
            return std::string(automatic);
        },
        [&field](const Option& option, const OptionValue& value) {
            if (is_auto(value)) {
                field.reset();
            } else {
                field = to_number(option, value);
            }
        });
}

void OptionTable::text(std::string name, std::string& field, std::string meaning) {
    bind(
        rows_, make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::text),
        [&field]() -> OptionValue { return field; },
        [&field](const Option& option, const OptionValue& value) {
            const auto* text = std::get_if<std::string>(&value);
            if (text == nullptr) refuse(option, value);
            field = *text;
        });
}

void OptionTable::add_choice(std::string name, std::vector<std::string> names,
                             std::function<std::string()> get,
                             std::function<void(const std::string&)> set, std::string meaning) {
    Option row = make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::choice);
    row.choices = std::move(names);
    bind(
        rows_, std::move(row), [get]() -> OptionValue { return get(); },
        [set](const Option& option, const OptionValue& value) {
            const auto* text = std::get_if<std::string>(&value);
            if (text == nullptr || std::ranges::find(option.choices, *text) == option.choices.end())
                refuse(option, value);
            set(*text);
        });
}

const Option* OptionTable::find(std::string_view name) const {
    const auto found = std::ranges::find(rows_, name, &Option::name);
    return found == rows_.end() ? nullptr : &*found;
}

void OptionTable::set(std::string_view name, const OptionValue& value) const {
    if (const Option* option = find(name)) return option->set(value);
    std::vector<std::string> names;
    for (const Option& row : rows_) names.push_back(row.name);
    const std::string nearest = nearest_name(name, names);
    throw OptionError(
        {.problem = fmt::format("'{}' has no option '{}'", section_, name),
         .actual = {},
         .expected = "one of " + joined(names, false),
         .suggestion = nearest.empty() ? "" : fmt::format("did you mean '{}'?", nearest)});
}

std::string to_text(const OptionValue& value) {
    return std::visit(Overloaded{[](bool on) { return std::string(on ? "true" : "false"); },
                                 [](const std::string& text) { return text; },
                                 [](auto number) { return fmt::format("{}", number); }},
                      value);
}

namespace {

// Optimal string alignment distance: insertions, deletions, replacements and neighbour swaps.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> cost(a.size() + 1,
                                               std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                cost[i][j] = i + j;
                continue;
            }
            const std::size_t replaced = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
            }
        }
    }
    return cost[a.size()][b.size()];
}

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t shortest_prefix = 3;
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    if (!best.empty() || word.size() < shortest_prefix) return best;
    const auto longer = std::ranges::find_if(
        candidates, [&](const std::string& candidate) { return candidate.starts_with(word); });
    return longer == candidates.end() ? std::string() : *longer;
}

}  // namespace grainfield
