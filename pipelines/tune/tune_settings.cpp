#include "pipelines/tune/tune_settings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace grainfield::pipelines {

namespace {

using tracking::Polarity;

std::string quoted(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '"' || c == '\\') escaped += '\\';
        escaped += c;
    }
    return "\"" + escaped + "\"";
}

/// Numbers and flags as they are; all else between quotation marks.
std::string toml_value(const OptionValue& value) {
    const std::string text = to_text(value);
    return std::holds_alternative<std::string>(value) ? quoted(text) : text;
}

/// Every option that is not what it is by default.
void add_given(const std::vector<OptionTable>& given, const std::vector<OptionTable>& by_default,
               std::vector<Setting>& settings) {
    for (std::size_t t = 0; t < given.size(); ++t) {
        const std::string section = given[t].section().empty() ? "track" : given[t].section();
        for (std::size_t r = 0; r < given[t].rows().size(); ++r) {
            const OptionValue value = given[t].rows()[r].get();
            if (value == by_default[t].rows()[r].get()) continue;
            settings.push_back({section, given[t].rows()[r].name, toml_value(value)});
        }
    }
}

void put(std::vector<Setting>& settings, const char* section, const char* name, std::string value) {
    const auto found = std::ranges::find_if(settings, [&](const Setting& setting) {
        return setting.section == section && setting.name == name;
    });
    if (found == settings.end()) {
        settings.push_back({section, name, std::move(value)});
    } else {
        found->value = std::move(value);
    }
}

}  // namespace

std::vector<Setting> suggested_settings(const Tuning& tuning, const FilmOptions& film) {
    std::vector<Setting> settings;
    FilmOptions given_film = film;
    FilmOptions usual_film;
    OptionTable film_table("");
    OptionTable usual_film_table("");
    describe(given_film, film_table);
    describe(usual_film, usual_film_table);
    add_given({film_table}, {usual_film_table}, settings);
    tracking::TrackOptions given = tuning.options;
    tracking::TrackOptions usual;
    add_given(tracking::describe(given), tracking::describe(usual), settings);

    const auto& model = tuning.model;
    put(settings, "calibrate", "polarity",
        model.polarity == Polarity::dark ? "\"dark\"" : "\"bright\"");
    put(settings, "calibrate", "disc-diameter", fmt::format("{:.3f}", model.disc.diameter));
    put(settings, "calibrate", "edge-width", fmt::format("{:.3f}", model.disc.edge_width));
    put(settings, "calibrate", "meeting-edges", fmt::format("\"{}\"", model.overlap->name()));
    put(settings, "calibrate", "profile",
        fmt::format("\"{}\"", model.correction.is_zero() ? model.disc.shape->name() : "learned"));
    // Steps far below the error buy nothing.
    const double tolerance = std::clamp(0.1 * tuning.median_error(), 0.003, 0.03);
    if (tolerance > 1.5 * tuning.options.refinement.tolerance) {
        put(settings, "refine", "tolerance", fmt::format("{:.3f}", tolerance));
    }
    std::ranges::stable_sort(settings, std::ranges::greater{}, &Setting::section);
    return settings;
}

std::string toml_of(const std::vector<Setting>& settings) {
    std::string text = "# Suggested by 'grainfield tune'; use with 'grainfield track -c'.\n";
    std::string section;
    for (const Setting& setting : settings) {
        if (setting.section != section) {
            section = setting.section;
            text += "\n[" + section + "]\n";
        }
        text += setting.name + " = " + setting.value + "\n";
    }
    return text;
}

}  // namespace grainfield::pipelines
