#include "core/option_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

bool in_range(const Range& range, double value) {
    if (std::isinf(value) && !range.may_be_infinite) return false;
    return value >= range.minimum && value <= range.maximum;
}

bool is_auto(const OptionValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    return text != nullptr && *text == automatic;
}

// Nothing if the value is of another kind or out of range.
template <class Field>
std::optional<Field> checked(const Option& option, const OptionValue& value) {
    const auto* whole = std::get_if<std::int64_t>(&value);
    if constexpr (std::is_same_v<Field, double>) {
        double number = std::numeric_limits<double>::quiet_NaN();
        if (const auto* real = std::get_if<double>(&value)) number = *real;
        if (whole != nullptr) number = static_cast<double>(*whole);
        if (in_range(option.range, number)) return number;
    } else if constexpr (std::is_same_v<Field, std::string>) {
        const auto* text = std::get_if<std::string>(&value);
        if (text != nullptr && std::ranges::find(option.choices, *text) != option.choices.end()) {
            return *text;
        }
    } else {
        if (whole != nullptr && std::in_range<Field>(*whole) &&
            in_range(option.range, static_cast<double>(*whole))) {
            return static_cast<Field>(*whole);
        }
    }
    return std::nullopt;
}

template <class Field>
Field require(const Option& option, const OptionValue& value) {
    const auto field = checked<Field>(option, value);
    if (!field) option.refuse(value);
    return *field;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t";
    const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
    return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

template <class Element>
std::vector<Element> require_list(const Option& option, const OptionValue& value) {
    const std::string text = to_text(value);
    std::vector<Element> elements;
    for (std::string_view rest = text; !trimmed(rest).empty();) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        const std::string_view word = trimmed(rest.substr(0, comma));
        const auto parsed = option.parsed(word);
        const auto element = parsed ? checked<Element>(option, *parsed) : std::nullopt;
        if (!element) option.refuse(value, word);
        elements.push_back(*element);
        rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    const bool is_default = elements.empty() && option.default_value == OptionValue(std::string());
    if (!is_default &&
        (elements.size() < option.count.minimum || elements.size() > option.count.maximum)) {
        option.refuse(value);
    }
    return elements;
}

template <class Element>
OptionValue list_text(const std::vector<Element>& elements) {
    std::string text;
    for (const Element& element : elements) {
        if (!text.empty()) text += ',';
        if constexpr (std::is_same_v<Element, std::string>) {
            text += element;
        } else {
            text += fmt::format("{}", element);
        }
    }
    return text;
}

Option make_row(std::string name, std::string unit, Range range, std::string meaning,
                OptionKind kind) {
    Option row;
    row.name = std::move(name);
    row.unit = std::move(unit);
    row.meaning = std::move(meaning);
    row.kind = kind;
    row.range = range;
    return row;
}

// Not called bind: std::bind would be found too, and fit better. Completes a row: `assign` gets the
// row as it will be described in messages, and the value.
template <class Get, class Assign>
void add_row(std::vector<Option>& rows, Option row, const void* field, Get get, Assign assign) {
    row.field = field;
    row.get = get;
    row.default_value = get();
    const Option description = row;
    row.set = [description, assign](const OptionValue& value) { assign(description, value); };
    rows.push_back(std::move(row));
}

template <class Field>
OptionValue value_or_auto(const std::optional<Field>& field) {
    if (!field) return std::string(automatic);
    if constexpr (std::is_same_v<Field, int>) return std::int64_t{*field};
    return *field;
}

/// A number that may be left to the program.
template <class Number>
void bind_or_auto(std::vector<Option>& rows, Option row, std::optional<Number>& field) {
    row.may_be_auto = true;
    add_row(
        rows, std::move(row), &field, [&field] { return value_or_auto(field); },
        [&field](const Option& option, const OptionValue& value) {
            if (is_auto(value)) {
                field.reset();
            } else {
                field = require<Number>(option, value);
            }
        });
}

template <class Integer>
void bind_integer(std::vector<Option>& rows, Option row, Integer& field) {
    add_row(
        rows, std::move(row), &field,
        [&field]() -> OptionValue { return static_cast<std::int64_t>(field); },
        [&field](const Option& option, const OptionValue& value) {
            field = require<Integer>(option, value);
        });
}

Option make_list(std::string name, std::string unit, Range range, std::string meaning,
                 OptionKind kind, Count count) {
    Option row = make_row(std::move(name), std::move(unit), range, std::move(meaning), kind);
    row.is_list = true;
    row.count = count;
    return row;
}

template <class Element>
void bind_list(std::vector<Option>& rows, Option row, std::vector<Element>& field) {
    add_row(
        rows, std::move(row), &field, [&field]() -> OptionValue { return list_text(field); },
        [&field](const Option& option, const OptionValue& value) {
            field = require_list<Element>(option, value);
        });
}

}  // namespace

void OptionTable::flag(std::string name, bool& field, std::string meaning) {
    add_row(
        rows_, make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::flag), &field,
        [&field]() -> OptionValue { return field; },
        [&field](const Option& option, const OptionValue& value) {
            const auto* on = std::get_if<bool>(&value);
            if (on == nullptr) option.refuse(value);
            field = *on;
        });
}

void OptionTable::flag(std::string name, std::optional<bool>& field, std::string meaning) {
    Option row = make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::flag);
    row.may_be_auto = true;
    add_row(
        rows_, std::move(row), &field, [&field] { return value_or_auto(field); },
        [&field](const Option& option, const OptionValue& value) {
            const auto* on = std::get_if<bool>(&value);
            if (on == nullptr && !is_auto(value)) option.refuse(value);
            field = on != nullptr ? std::optional(*on) : std::nullopt;
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

void OptionTable::integer(std::string name, std::optional<int>& field, std::string unit,
                          Range range, std::string meaning) {
    bind_or_auto(
        rows_,
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::integer),
        field);
}

void OptionTable::number(std::string name, double& field, std::string unit, Range range,
                         std::string meaning) {
    add_row(
        rows_,
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::number),
        &field, [&field]() -> OptionValue { return field; },
        [&field](const Option& option, const OptionValue& value) {
            field = require<double>(option, value);
        });
}

void OptionTable::number(std::string name, std::optional<double>& field, std::string unit,
                         Range range, std::string meaning) {
    bind_or_auto(
        rows_,
        make_row(std::move(name), std::move(unit), range, std::move(meaning), OptionKind::number),
        field);
}

void OptionTable::text(std::string name, std::string& field, std::string meaning) {
    add_row(
        rows_, make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::text), &field,
        [&field]() -> OptionValue { return field; },
        [&field](const Option& option, const OptionValue& value) {
            const auto* text = std::get_if<std::string>(&value);
            if (text == nullptr) option.refuse(value);
            field = *text;
        });
}

void OptionTable::integers(std::string name, std::vector<int>& field, std::string unit, Range range,
                           std::string meaning, Count count) {
    bind_list(rows_,
              make_list(std::move(name), std::move(unit), range, std::move(meaning),
                        OptionKind::integer, count),
              field);
}

void OptionTable::integers(std::string name, std::vector<std::int64_t>& field, std::string unit,
                           Range range, std::string meaning, Count count) {
    bind_list(rows_,
              make_list(std::move(name), std::move(unit), range, std::move(meaning),
                        OptionKind::integer, count),
              field);
}

void OptionTable::numbers(std::string name, std::vector<double>& field, std::string unit,
                          Range range, std::string meaning, Count count) {
    bind_list(rows_,
              make_list(std::move(name), std::move(unit), range, std::move(meaning),
                        OptionKind::number, count),
              field);
}

void OptionTable::numbers(std::string name, std::optional<std::vector<double>>& field,
                          std::string unit, Range range, std::string meaning, Count count) {
    Option row = make_list(std::move(name), std::move(unit), range, std::move(meaning),
                           OptionKind::number, count);
    row.may_be_auto = true;
    add_row(
        rows_, std::move(row), &field,
        [&field]() -> OptionValue { return field ? list_text(*field) : std::string(automatic); },
        [&field](const Option& option, const OptionValue& value) {
            if (is_auto(value)) {
                field.reset();
            } else {
                field = require_list<double>(option, value);
            }
        });
}

void OptionTable::names(std::string name, std::vector<std::string>& field,
                        std::vector<std::string> choices, std::string meaning, Count count) {
    Option row = make_list(std::move(name), {}, {}, std::move(meaning), OptionKind::choice, count);
    row.choices = std::move(choices);
    bind_list(rows_, std::move(row), field);
}

void OptionTable::add_choice(std::string name, std::vector<std::string> names, const void* field,
                             std::function<std::string()> get,
                             std::function<void(const std::string&)> set, std::string meaning) {
    Option row = make_row(std::move(name), {}, {}, std::move(meaning), OptionKind::choice);
    row.choices = std::move(names);
    add_row(
        rows_, std::move(row), field, [get]() -> OptionValue { return get(); },
        [set](const Option& option, const OptionValue& value) {
            set(require<std::string>(option, value));
        });
}

const Option* OptionTable::find(std::string_view name) const {
    const auto found =
        std::ranges::find_if(rows_, [name](const Option& row) { return row.is_called(name); });
    return found == rows_.end() ? nullptr : &*found;
}

const Option& OptionTable::row_of(const void* field) const {
    const auto found = std::ranges::find(rows_, field, &Option::field);
    if (found == rows_.end()) throw std::logic_error("no option is bound to this field");
    return *found;
}

void OptionTable::set(std::string_view name, const OptionValue& value) const {
    if (const Option* option = find(name)) return option->set(value);
    std::vector<std::string> names;
    std::string known;
    for (const Option& row : rows_) {
        names.push_back(row.name);
        known += (known.empty() ? "" : ", ") + row.name;
    }
    const std::string nearest = nearest_name(name, names);
    throw OptionError(
        {.problem = fmt::format("'{}' has no option '{}'", section_, name),
         .actual = {},
         .expected = "one of " + known,
         .suggestion = nearest.empty() ? "" : fmt::format("did you mean '{}'?", nearest)});
}

}  // namespace grainfield
