#include "pipelines/detail/toml_values.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::pipelines {

namespace {

template <class Number>
std::string plain(Number value) {
    return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

}  // namespace

std::string text_of_number(double value) {
    return plain(value);
}

std::string text_of_number(float value) {
    return plain(value);
}

TomlValues::TomlValues(const std::filesystem::path& path, const std::string& what,
                       std::string origin, std::string suggestion)
    : file_(path.string()), suggestion_(std::move(suggestion)) {
    std::ifstream in;
    if (std::filesystem::is_regular_file(path)) in.open(path, std::ios::binary);
    if (!in.is_open()) {
        refuse(fmt::format("cannot be read as a {}", what), "", std::move(origin));
    }
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    try {
        root_ = parsed_toml(text);
    } catch (const toml::parse_error& error) {
        refuse(fmt::format("line {}: not valid TOML", error.source().begin.line),
               std::string(error.description()), std::move(origin));
    }
}

double TomlValues::number(const std::string& key, double low, double high) {
    const auto value = node(key).value<double>();
    if (!value || !(*value >= low && *value <= high)) {
        refuse_value(key, fmt::format("a number from {} to {}", low, high));
    }
    return *value;
}

int TomlValues::whole(const std::string& key, int low, int high) {
    const auto value = node(key).value_exact<std::int64_t>();
    if (!value || *value < low || *value > high) {
        refuse_value(key, fmt::format("a whole number from {} to {}", low, high));
    }
    return static_cast<int>(*value);
}

std::vector<double> TomlValues::list(const std::string& key) {
    std::vector<double> values;
    const toml::node_view<const toml::node> found = node(key);
    const toml::array* array = found.as_array();
    if (array == nullptr) refuse_value(key, "a list of numbers");
    for (const toml::node& element : *array) {
        const auto value = element.value<double>();
        if (!value || !std::isfinite(*value)) refuse_value(key, "a list of numbers");
        values.push_back(*value);
    }
    return values;
}

std::string TomlValues::text(const std::string& key) {
    const auto value = node(key).value<std::string>();
    if (!value) refuse_value(key, "a text");
    return *value;
}

bool TomlValues::has(const std::string& key) const {
    return static_cast<bool>(root_.at_path(key));
}

void TomlValues::require_no_others() const {
    require_known(root_, "");
}

void TomlValues::require_known(const toml::table& table, const std::string& before) const {
    for (const auto& [key, value] : table) {
        const std::string name = before + std::string(key.str());
        if (asked_.contains(name)) continue;
        const toml::table* section = value.as_table();
        if (section == nullptr) refuse(fmt::format("unknown key '{}'", name), "", "");
        require_known(*section, name + ".");
    }
}

void TomlValues::refuse_value(const std::string& key, std::string expected) const {
    refuse(fmt::format("key '{}' is missing or wrong", key), "", std::move(expected));
}

void TomlValues::refuse(const std::string& problem, std::string actual,
                        std::string expected) const {
    throw InputError({.problem = fmt::format("'{}': {}", file_, problem),
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = suggestion_});
}

toml::node_view<const toml::node> TomlValues::node(const std::string& key) {
    asked_.insert(key);
    return std::as_const(root_).at_path(key);
}

}  // namespace grainfield::pipelines
