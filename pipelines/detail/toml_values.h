#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipelines/detail/toml_text.h"

namespace grainfield::pipelines {

/// A number as TOML has it, every bit of it: it has no negative zero without a point.
std::string text_of_number(double value);
std::string text_of_number(float value);

/// "[1, 2.5]"
template <class Number>
std::string list_of(const std::vector<Number>& values) {
    std::string text = "[";
    for (const Number value : values) text += (text.size() > 1 ? ", " : "") + text_of_number(value);
    return text + "]";
}

/// The values of a TOML file, each to be asked for once by "section.key". Throws InputError with
/// file and key: a file that cannot be read, a key that is missing, unknown or of a wrong value.
class TomlValues {
 public:
    /// `what`: "calibration", and `origin` "a file of --save-calibration", for messages.
    TomlValues(const std::filesystem::path& path, const std::string& what, std::string origin,
               std::string suggestion);

    double number(const std::string& key, double low, double high);
    int whole(const std::string& key, int low, int high);
    std::vector<double> list(const std::string& key);
    std::string text(const std::string& key);

    template <class Choice>
    Choice choice(const std::string& key, const std::map<std::string, Choice>& choices) {
        const auto value = node(key).value<std::string>();
        const auto found = value ? choices.find(*value) : choices.end();
        if (found == choices.end()) {
            std::string names;
            for (const auto& [name, meaning] : choices) names += (names.empty() ? "" : ", ") + name;
            refuse_value(key, "one of " + names);
        }
        return found->second;
    }

    /// Whether there is such a section or key.
    bool has(const std::string& key) const;
    /// Throws for keys that nobody asked for.
    void require_no_others() const;
    [[noreturn]] void refuse_value(const std::string& key, std::string expected) const;
    [[noreturn]] void refuse(const std::string& problem, std::string actual,
                             std::string expected) const;

 private:
    toml::node_view<const toml::node> node(const std::string& key);
    void require_known(const toml::table& table, const std::string& before) const;

    std::string file_;
    std::string suggestion_;
    toml::table root_;
    std::set<std::string> asked_;
};

}  // namespace grainfield::pipelines
