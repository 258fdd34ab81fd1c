#include "pipelines/tune/tune_settings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tracking/model/known_models.h"

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

/// Options of no section stand in that of `track` itself.
constexpr const char* command_section = "track";

/// Every option that is not what it is by default.
void add_given(const std::vector<OptionTable>& given, const std::vector<OptionTable>& by_default,
               std::vector<Setting>& settings) {
    for (std::size_t t = 0; t < given.size(); ++t) {
        const std::string section =
            given[t].section().empty() ? command_section : given[t].section();
        for (std::size_t r = 0; r < given[t].rows().size(); ++r) {
            const OptionValue value = given[t].rows()[r].get();
            if (value == by_default[t].rows()[r].get()) continue;
            settings.push_back({section, given[t].rows()[r].name, toml_value(value)});
        }
    }
}

/// Sets the option that is bound to `field`.
void put(std::vector<Setting>& settings, const OptionTable& table, const void* field,
         std::string value) {
    const std::string& name = table.row_of(field).name;
    const auto found = std::ranges::find_if(settings, [&](const Setting& setting) {
        return setting.section == table.section() && setting.name == name;
    });
    if (found == settings.end()) {
        settings.push_back({table.section(), name, std::move(value)});
    } else {
        found->value = std::move(value);
    }
}

/// The text of an option that is a choice.
std::string choice_text(const OptionTable& table, const void* field) {
    return toml_value(table.row_of(field).get());
}

/// What was estimated, in place of what was given.
void put_model(const tracking::ImageModel& model, std::vector<Setting>& settings) {
    tracking::CalibrationOptions found;
    found.polarity = model.polarity == Polarity::dark ? tracking::PolarityChoice::dark
                                                      : tracking::PolarityChoice::bright;
    found.meeting_edges = model.overlap;
    found.profile = model.correction.is_zero()
                        ? tracking::ProfileChoice{model.disc.shape, tracking::Learning::never}
                        : tracking::ProfileChoice{tracking::profile_shapes().front(),
                                                  tracking::Learning::always};
    const OptionTable table = describe(found);
    put(settings, table, &found.polarity, choice_text(table, &found.polarity));
    put(settings, table, &found.diameter, fmt::format("{:.3f}", model.disc.diameter));
    put(settings, table, &found.edge_width, fmt::format("{:.3f}", model.disc.edge_width));
    put(settings, table, &found.meeting_edges, choice_text(table, &found.meeting_edges));
    put(settings, table, &found.profile, choice_text(table, &found.profile));
}

/// All that the user gave, of the film and of the tracker.
std::vector<Setting> given_settings(const tracking::TrackOptions& tracking,
                                    const FilmOptions& film) {
    std::vector<Setting> settings;
    FilmOptions given_film = film;
    FilmOptions usual_film;
    OptionTable film_table("");
    OptionTable usual_film_table("");
    describe(given_film, film_table);
    describe(usual_film, usual_film_table);
    add_given({film_table}, {usual_film_table}, settings);
    tracking::TrackOptions given = tracking;
    tracking::TrackOptions usual;
    add_given(tracking::describe(given), tracking::describe(usual), settings);
    return settings;
}

/// A polarity, in place of what was given.
void put_polarity(Polarity polarity, tracking::CalibrationOptions& chosen,
                  std::vector<Setting>& settings) {
    chosen.polarity = polarity == Polarity::dark ? tracking::PolarityChoice::dark
                                                 : tracking::PolarityChoice::bright;
    const OptionTable table = describe(chosen);
    put(settings, table, &chosen.polarity, choice_text(table, &chosen.polarity));
}

/// A section stands together, that of the command first.
void sort_sections(std::vector<Setting>& settings) {
    std::ranges::stable_sort(settings, std::ranges::greater{}, &Setting::section);
}

}  // namespace

std::vector<Setting> suggested_settings(const Tuning& tuning, const FilmOptions& film) {
    std::vector<Setting> settings = given_settings(tuning.options, film);
    put_model(tuning.model, settings);
    // Steps far below the error buy nothing.
    const double tolerance = std::clamp(0.1 * tuning.median_error(), 0.003, 0.03);
    if (tolerance > 1.5 * tuning.options.refinement.tolerance) {
        tracking::RefinementOptions refinement;
        put(settings, describe(refinement), &refinement.tolerance,
            fmt::format("{:.3f}", tolerance));
    }
    sort_sections(settings);
    return settings;
}

std::vector<Setting> settings_with(const tracking::TrackOptions& given, const FilmOptions& film,
                                   const TriedSettings& tried) {
    std::vector<Setting> settings = given_settings(given, film);
    tracking::CalibrationOptions chosen;
    put_polarity(tried.polarity, chosen, settings);
    put(settings, describe(chosen), &chosen.diameter, fmt::format("{:.2f}", tried.diameter));
    if (tried.evidence) {
        tracking::DetectionOptions detection;
        put(settings, describe(detection), &detection.evidence,
            fmt::format("{:.3f}", *tried.evidence));
    }
    sort_sections(settings);
    return settings;
}

std::vector<Setting> settings_of(const tracking::TrackOptions& given, const FilmOptions& film,
                                 const tracking::SizeCandidate& candidate) {
    tracking::TrackOptions options = given;
    options.calibration.edge_width.reset();
    return settings_with(options, film, {candidate.polarity, candidate.diameter, {}});
}

std::vector<Setting> settings_instead(const Tuning& tuning, const FilmOptions& film,
                                      const tracking::SizeCandidate& candidate) {
    tracking::TrackOptions options = tuning.options;
    options.calibration.diameter.reset();
    options.calibration.edge_width.reset();
    std::vector<Setting> settings = given_settings(options, film);
    tracking::CalibrationOptions chosen;
    put_polarity(candidate.polarity, chosen, settings);
    sort_sections(settings);
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
