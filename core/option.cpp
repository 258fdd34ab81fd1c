#include "core/option.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

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
    const bool has_minimum = std::isfinite(option.range.minimum);
    const bool has_maximum = std::isfinite(option.range.maximum);
    if (has_minimum && has_maximum)
        return fmt::format("{:g} … {:g}", option.range.minimum, option.range.maximum);
    if (has_minimum) return fmt::format("≥ {:g}", option.range.minimum);
    if (has_maximum) return fmt::format("≤ {:g}", option.range.maximum);
    return {};
}

std::string joined(const std::vector<std::string>& names, bool with_auto) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    if (with_auto) text += std::string(text.empty() ? "" : ", ") + automatic;
    return text;
}

const char* words_for(const Option& option) {
    switch (option.kind) {
        case OptionKind::flag:
            return "true or false";
        case OptionKind::text:
            return option.is_list ? "texts" : "a text";
        case OptionKind::choice:
            return option.is_list ? "some of " : "one of ";
        case OptionKind::integer:
            return option.is_list ? "integers" : "an integer";
        case OptionKind::number:
            return option.is_list ? "numbers" : "a number";
    }
    return "";
}

std::string count_text(const Count& count) {
    constexpr Count any;
    if (count.minimum == count.maximum) return fmt::format("{} ", count.minimum);
    if (count.minimum > 1) return fmt::format("at least {} ", count.minimum);
    if (count.maximum < any.maximum) return fmt::format("at most {} ", count.maximum);
    return {};
}

bool is_numeric(const Option& option) {
    return option.kind == OptionKind::integer || option.kind == OptionKind::number;
}

std::string expectation(const Option& option) {
    std::string text = (option.is_list ? count_text(option.count) : "") + words_for(option);
    if (option.kind == OptionKind::choice) text += joined(option.choices, option.may_be_auto);
    if (is_numeric(option)) {
        if (const std::string range = range_text(option); !range.empty()) text += " " + range;
        if (option.range.may_be_infinite) text += " or inf";
        text += with_unit(option);
    }
    if (option.may_be_auto && option.kind != OptionKind::choice) text += " or auto";
    if (option.is_list) text += ", with commas between them";
    return text;
}

// "10.09px" or "10.09 px" of an option in px; "500 1/s", "500/s", "500Hz", "500fps" of one in 1/s,
// where "5001/s" is 5001 a second.
std::string_view without_unit(std::string_view text, std::string_view unit) {
    if (unit.empty() || unit == "-") return text;
    const bool is_reciprocal = unit.starts_with("1/");
    std::vector<std::string> spellings{fmt::format("{}{}", is_reciprocal ? " " : "", unit)};
    if (is_reciprocal) spellings.emplace_back(unit.substr(1));
    if (unit == "1/s") spellings.insert(spellings.end(), {"Hz", "fps"});
    for (const std::string& spelling : spellings) {
        if (!text.ends_with(spelling)) continue;
        text.remove_suffix(spelling.size());
        while (text.ends_with(' ')) text.remove_suffix(1);
        break;
    }
    return text;
}

}  // namespace

void Option::refuse(const OptionValue& value, std::string_view element) const {
    const std::string whole = to_text(value);
    std::string suggestion;
    if (kind == OptionKind::choice) {
        const std::string word = element.empty() ? whole : std::string(element);
        const std::string nearest = nearest_name(word, choices);
        if (!nearest.empty()) suggestion = fmt::format("did you mean '{}'?", nearest);
    }
    throw OptionError({.problem = fmt::format("option '{}' has a wrong value", name),
                       .actual = element.empty() ? fmt::format("'{}'", whole)
                                                 : fmt::format("'{}' in '{}'", element, whole),
                       .expected = expectation(*this),
                       .suggestion = suggestion});
}

std::optional<OptionValue> Option::parsed(std::string_view text) const {
    if (is_numeric(*this)) text = without_unit(text, unit);
    switch (kind) {
        case OptionKind::flag:
            for (const char* yes : {"true", "yes", "on", "1"}) {
                if (text == yes) return true;
            }
            for (const char* no : {"false", "no", "off", "0"}) {
                if (text == no) return false;
            }
            break;
        case OptionKind::integer:
            if (const auto whole = parse<std::int64_t>(text)) return *whole;
            break;
        case OptionKind::number:
            if (const auto real = parse<double>(text)) return *real;
            break;
        case OptionKind::text:
        case OptionKind::choice:
            return std::string(text);
    }
    return std::nullopt;
}

bool Option::is_called(std::string_view word) const {
    return name == word || std::ranges::find(other_names, word) != other_names.end();
}

void Option::set_from_text(std::string_view text) const {
    if (is_list || (may_be_auto && text == automatic)) return set(std::string(text));
    const auto value = parsed(text);
    if (!value) refuse(std::string(text));
    set(*value);
}

std::string Option::domain_text() const {
    std::string text;
    if (kind == OptionKind::choice) text = words_for(*this) + joined(choices, may_be_auto);
    if (!unit.empty()) text = "[" + unit + "]";
    if (const std::string limits = range_text(*this); !limits.empty()) {
        text += (text.empty() ? "" : " ") + limits;
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
